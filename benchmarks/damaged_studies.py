"""A thousand damaged copies of a small study: none may be read with altered values.

    python benchmarks/damaged_studies.py [COPIES]

Each copy of `study.sqlite` gets a flipped bit, twenty of them, a stretch of zeros or noise, or
loses its end, at a place drawn by its number. It is then read as `camring report` reads it,
and opened as `camring resume` opens it.
"""

import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "helpers"))

import damage
import fake_study


def main(copies: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study"
        fake_study.run(study, budget=40)
        whole = damage.content_of(study)
        read, gone_on, kinds = Counter(), Counter(), Counter()
        for seed in range(copies):
            place = Path(folder) / "copy"
            kind = damage.damaged_copy(study, place, seed)
            came = damage.came_to(whole, place)[0]
            read[came] += 1
            kinds[f"{kind}: {came}"] += 1
            gone_on[damage.came_to(whole, place, write=True)[0]] += 1
            shutil.rmtree(place)
    print(f"{copies} damaged copies of a study of 40 evaluations")
    for title, counts in (("read", read), ("opened to go on", gone_on), ("by kind", kinds)):
        print(f"{title}: " + ", ".join(f"{name} {n}" for name, n in sorted(counts.items())))
    if read[damage.ALTERED] or gone_on[damage.ALTERED] or gone_on[damage.NAMED]:
        sys.exit("altered values were read without a word")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
