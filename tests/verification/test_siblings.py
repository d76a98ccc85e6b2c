"""Measures of a job beside another one of the same case."""

import pytest
from post_runs import bar_deck
from tessera_post.errors import PostError
from tessera_post.job import Job
from verification.siblings import ratio_to_sibling


def test_sibling_gives_the_ratio_at_a_time(run_deck, tmp_path):
    for name, strength in (("weak", "10.0"), ("strong", "20.0")):
        run_deck(tmp_path, bar_deck(strength=strength), name=name)
    weak, strong = (Job(tmp_path / f"{name}.vtkhdf") for name in ("weak", "strong"))
    column = "RF1[X1]"
    time, expected = strong.history["time"][2], weak.history[column][2] / strong.history[column][2]
    assert 0.4 < expected < 0.9
    assert ratio_to_sibling(weak, "strong", column, time) == expected
    assert ratio_to_sibling(weak, "weak", column, time) == 1.0
    with pytest.raises(ValueError, match=r"no increment of weak ends at 0\.77"):
        ratio_to_sibling(weak, "strong", column, 0.77)
    with pytest.raises(PostError):
        ratio_to_sibling(weak, "none", column, time)
    weak.close()
    strong.close()
