"""The keywords of the program as data, and cards made of them."""

import json
import subprocess
from pathlib import Path
from random import Random

from fuzzing import words


class Schema:
    """What `tessera --schema` says."""

    def __init__(self, program: Path) -> None:
        run = subprocess.run([program, "--schema"], capture_output=True, text=True, check=True)
        self.keywords = json.loads(run.stdout)["keywords"]
        self.names = [keyword["keyword"] for keyword in self.keywords]
        self.parameters = sorted({p["name"] for k in self.keywords for p in k["parameters"]})
        self.choices = sorted({
            choice
            for keyword in self.keywords
            for rule in keyword["parameters"]
            + [field for line in keyword["data"]["lines"] for field in line["fields"]]
            for choice in rule.get("choices", ())
        })  # fmt: skip

    def value(self, random: Random, rule: dict) -> str:
        """A value of a parameter or a field, right more often than not."""
        if random.random() < 0.12:
            return random.choice((words.number, words.word))(random)
        kind = rule["type"]
        if kind == "choice":
            return random.choice(rule["choices"])
        if kind == "integer":
            return random.choice("12345")
        if kind == "real":
            return random.choice(("0.5", "1", "1e-3", "0.25", "2.", "-0.1"))
        if kind == "reals":
            return random.choice(("0,1", "0,0,1", "1,0", "1,1,1", "0,0"))
        return random.choice(words.WORDS[:14])

    def head(self, random: Random, keyword: dict) -> str:
        """A keyword line."""
        parts = [keyword["keyword"]]
        for rule in keyword["parameters"]:
            if random.random() > (0.9 if rule["required"] else 0.35):
                continue
            value = self.value(random, rule)
            parts.append(rule["name"] if rule["type"] == "flag" else f"{rule['name']}={value}")
        return ", ".join(parts)

    def data(self, random: Random, keyword: dict) -> str:
        """A data line."""
        lines = keyword["data"]["lines"]
        if not lines:
            return words.word(random)
        fields = []
        for rule in random.choice(lines)["fields"]:
            if not rule["required"] and random.random() < 0.4:
                break
            fields += [self.value(random, rule) for _ in range(rule.get("count", 1))]
        return ", ".join(fields)

    def card(self, random: Random) -> list[bytes]:
        """A card with its data lines."""
        keyword = random.choice(self.keywords)
        lines = [self.head(random, keyword)]
        most = min(keyword["data"]["max"] or 3, 3)
        if most > 0:
            n = random.randint(0, most)
            lines += [self.data(random, keyword) for _ in range(max(n, keyword["data"]["min"]))]
        return [line.encode("utf-8", "surrogatepass") for line in lines]
