"""Sources of the methods: who publishes what a module of the estimator computes.

A source is a DOI, an equation or section of the thesis, a numbered standard, or a citation with volume or publisher and year.
It stands in the docstring of the module, of a class or of a function; one place in a module is enough. A module is due one
when it solves something numerically, or when its docstrings name somebody's method. What was derived for this project stands
in `OWN`, with the place of its derivation.
"""

import ast
import re
from functools import cache

import pytest

from tests.paths import ROOT
from tests.syntax_trees import parsed, statements

SOLVES = re.compile(r"\bscipy\.\w|\bnp\.(?:linalg|fft)\b")
"""Code that solves something: linear algebra, transforms, optimisation, interpolation, distributions."""
SOURCE = re.compile(
    r"doi:10\.\d{4,9}/\S+"
    r"|\b[Tt]hesis,? (?:Eq\. |§|Appendix |Table |Chapter )"
    r"|\bEq\. [A-F\d]\.\d"
    r"|\b(?:API|API RP|ISO|JCGM|IEEE Std) \d{3,}"
    r"|\b\d{1,3} \((?:18|19|20)\d\d\) \w?\d+"  # volume, year, page
    r"|(?:Wiley|Springer|Oxford|Berlin|ed\.|IMAC,|[a-z]{4},) (?:18|19|20)\d\d\b"  # publisher or title, year
)
METHODS = re.compile(
    r"\b(?:Akaike|Allemang|Bayley|Bennett|Butland|Cowper|Craig|Crowder|DerSimonian|Durbin|Fritsch|Guyan|Hamed|Hoerl|Kendall"
    r"|Mahalanobis|Marquardt|Newmark|Patterson|Reynolds|Rubin|Satterthwaite|Schwarz|Sen|Smyth|Theil|Tikhonov|Venzon|Wiener)\b"
)
"""Names of authors whose methods are meant where they occur."""
OWN = {
    "alignment/run_likelihood.py": "a posterior over its prior, in the module's docstring",
    "diagnosis/film_reference.py": "the same, and what the diagnosis makes of it",
    "balancing/trial_runs.py": "the rank of a matrix of weights, whose method is measured_influence's",
    "balancing/vectors_at_speeds.py": "a straight line over a narrow window, in the module's docstring",
    "diagnosis/observation.py": "a second-order expansion of the likelihood, in the module's docstring",
    "calibration/calibration_runs.py": "counts and compares what runs state",
    "films/pad_table.py": "coordinates of an interpolation, in the module's docstring",
    "fit/problem/fit_problem.py": "χ² and its derivatives, which the fit's method minimises",
    "fit/validation/identifiability.py": "reads a covariance whose source is the fit's",
    "identification/sweep_correction.py": "derived in the module's docstring",
    "machine/calibration.py": "a document's part; the method is in calibration/",
    "phasors/beating.py": "derived in the module's docstring",
    "phasors/modal_transient.py": "derived in the module's docstring",
    "phasors/orbits.py": "geometry of ellipses, and the response's growth over speed",
    "phasors/probe_axes.py": "two equations, in the module's docstring",
    "updated_model/monotone_segments.py": "a cubic spline and its turns",
}
"""Modules that solve something by no published method, and where their formulas come from."""
ROOM = ROOT / "estimator"
MODULES = sorted(path.relative_to(ROOM).as_posix() for path in ROOM.rglob("*.py"))


@cache
def text(module: str) -> str:
    """All of a module's source."""
    return (ROOM / module).read_text()


@cache
def docstrings(source: str) -> str:
    """All docstrings in some source, each on lines of its own."""
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    nodes = (node for node in statements(parsed(source)) if isinstance(node, documented))
    return re.sub(r"[ \n]+", " ", "\n".join(ast.get_docstring(node) or "" for node in nodes))


def is_due(source: str) -> bool:
    """Return whether some source needs to say who published its method."""
    return SOLVES.search(source) is not None or METHODS.search(docstrings(source)) is not None


def is_given(source: str) -> bool:
    """Return whether some source says so."""
    return SOURCE.search(docstrings(source)) is not None


@pytest.mark.parametrize("module", [one for one in MODULES if one not in OWN and is_due(text(one))])
def test_a_published_method_has_its_source(module: str) -> None:
    assert is_given(text(module)), (
        f"estimator/{module} solves something: say in a docstring who published the method (doi:…, thesis Eq. …, a standard, "
        "a book with its year), or state in OWN of this test where it is derived"
    )


@pytest.mark.parametrize("module", [one for one in MODULES if one.startswith("thesis/")])
def test_methods_of_the_thesis_say_where_it_has_them(module: str) -> None:
    assert re.search(r"[Tt]hesis|Lal", docstrings(text(module)))
    assert module == "thesis/__init__.py" or is_given(text(module))


def test_what_is_listed_as_own_still_is() -> None:
    assert [one for one in OWN if one not in MODULES or not is_due(text(one)) or is_given(text(one))] == []


def test_the_whole_paper_can_be_found() -> None:
    """A DOI ends where the sentence goes on; a truncated one leads nowhere."""
    for module in MODULES:
        for doi in re.findall(r"doi:(\S*)", docstrings(text(module))):
            assert re.fullmatch(r"10\.\d{4,9}/[\w.()/-]*[\w)][.,;:)]*", doi), f"estimator/{module}: {doi}"


@pytest.mark.parametrize(
    ("docstring", "due", "given"),
    [
        ("Compute a mean.", False, False),
        ("Slope of Theil and Sen.", True, False),
        ("Slope of Theil and Sen (doi:10.1080/01621459.1968.10480934).", True, True),
        ("Fit as Marquardt does (J. SIAM 11 (1963) 431).", True, True),
        ("Response, thesis Eq. 3.23.", False, True),
        ("Grade after ISO 21940.", False, True),
        ("In 2008 (see there) nothing was published.", False, False),
    ],
)
def test_sources_are_told_from_words(docstring: str, due: bool, given: bool) -> None:
    source = f'"""{docstring}"""\n'
    assert (is_due(source), is_given(source)) == (due, given)
    assert is_due(f"{source}import scipy.linalg\n")
