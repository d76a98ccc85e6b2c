"""The page of the report: template, style, scripts, and the rule that nothing is fetched."""

import base64
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from tessera_post import __version__, report_tables
from tessera_post.deck_lexer import deck_html
from tessera_post.job import Job
from tessera_post.report_attempts import PARTS, Trial, cut_backs, sums
from tessera_post.report_pictures import Picture
from tessera_post.report_plots import Plot


@dataclass(frozen=True)
class Sections:
    """What has to be drawn or computed for the page."""

    trials: Sequence[Trial]
    reaction: Plot | None
    histories: Sequence[Plot]
    convergence: Sequence[Plot]
    pictures: Sequence[Picture]
    view: Plot | None


@cache
def environment() -> Environment:
    """Templates; whatever is put in is escaped."""
    return Environment(
        loader=PackageLoader("tessera_post", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def script(text: str) -> Markup:
    """Text for a script element of our own making: no end tag inside, one kind of line end."""
    return Markup(text.replace("\r", "").replace("</script", "<\\/script"))


def policy(scripts: Sequence[str]) -> str:
    """What the browser may do: run these scripts and no others, and fetch nothing at all."""
    hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
    allowed = " ".join(f"'sha256-{value}'" for value in hashes)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline';"
        " img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def source(name: str) -> str:
    """A file of the package."""
    return resources.files("tessera_post").joinpath(name).read_text(encoding="utf-8")


def render(job: Job, sections: Sections) -> str:
    """The page."""
    plotly = script(get_plotlyjs())
    drawing = script(source("report_script.js.j2"))
    deck = job.deck.decode("utf-8", errors="replace")
    return (
        environment()
        .get_template("report.html.j2")
        .render(
            job=job,
            title=job.heading or job.name,
            status=report_tables.status_of(job),
            about=report_tables.about(job),
            why_no_verdicts=report_tables.why_no_verdicts(job),
            settings=report_tables.settings_of(job),
            sizes=report_tables.sizes_of(job),
            sets=report_tables.sets_of(job),
            ledger=report_tables.ledger_of(job),
            parts=PARTS,
            sums=sums(sections.trials),
            cut_backs=cut_backs(sections.trials),
            deck=Markup(deck_html(deck)),  # escaped by Pygments
            css=Markup(source("report.css")),
            policy=policy([plotly, drawing]),
            plotly=plotly,
            drawing=drawing,
            version=__version__,
            **vars(sections),
        )
    )
