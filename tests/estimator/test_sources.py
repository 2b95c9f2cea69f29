"""Sources of the methods: who publishes what a module of the estimator computes.

A source is a DOI, an equation or section of the thesis, a numbered standard, or a citation with volume or publisher and year.
It stands in the docstring of the module, of a class or of a function; one place in a module is enough. A module is due one
when it solves something numerically, or when its docstrings name somebody's method. What was derived for this project stands
in `OWN`, with the place of its derivation.

A public function that solves something, by itself or by private functions of its module, says in its own docstring or in that
of its class where its method comes from: such a source, or "Source: standard result: …" for what every textbook has, or
"Source: own derivation: …" for what was derived here.
"""

import ast
import re
from functools import cache

import pytest

from tests.estimator.test_docstrings import public_functions
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
    "diagnosis/observation.py": "a second-order expansion of the likelihood, in the module's docstring",
    "calibration/calibration_runs.py": "counts and compares what runs state",
    "films/pad_table.py": "coordinates of an interpolation, in the module's docstring",
    "fit/validation/identifiability.py": "reads a covariance whose source is the fit's",
    "machine/calibration.py": "a document's part; the method is in calibration/",
    "phasors/sweep_transient.py": "derived in the module's docstring",
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


Function = ast.FunctionDef | ast.AsyncFunctionDef
UNPUBLISHED = re.compile(r"\bSource: (?:standard result|own derivation): \w")


def functions_with_source(source: str) -> dict[str, bool]:
    """Return whether each public function of some source that solves something says where its method comes from."""
    tree = parsed(source)
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    found = {}
    for name, function in public_functions(tree):
        owner = classes.get(name.partition(".")[0]) if "." in name else None
        if _solves(function, _private(tree.body), _private(owner.body if owner else [])):
            stated = " ".join((ast.get_docstring(function) or "").split() + (_docstring_words(owner) if owner else []))
            found[name] = bool(SOURCE.search(stated) or UNPUBLISHED.search(stated))
    return found


def _docstring_words(node: ast.ClassDef) -> list[str]:
    return (ast.get_docstring(node) or "").split()


def _private(body: list[ast.stmt]) -> dict[str, Function]:
    return {node.name: node for node in body if isinstance(node, Function) and node.name.startswith("_")}


def _solves(function: Function, of_module: dict[str, Function], of_class: dict[str, Function]) -> bool:
    """Return whether a function solves something, or a private function of its module or class that it uses."""
    seen, waiting = set[str](), [function]
    while waiting:
        one = waiting.pop()
        if SOLVES.search(ast.unparse(one)):
            return True
        for node in ast.walk(one):
            used = of_module.get(node.id) if isinstance(node, ast.Name) else None
            used = of_class.get(node.attr) if isinstance(node, ast.Attribute) else used
            if used is not None and used.name not in seen:
                seen.add(used.name)
                waiting.append(used)
    return False


@pytest.mark.parametrize("module", MODULES)
def test_a_public_function_that_solves_something_has_its_source(module: str) -> None:
    without = [name for name, given in functions_with_source(text(module)).items() if not given]
    assert without == [], (
        f"estimator/{module}: say in the docstring who published the method, or 'Source: standard result: …', or 'Source: own "
        "derivation: …' in a few words"
    )


def test_functions_that_solve_something_are_distinguished_from_others() -> None:
    source = """
def mean(a): return a / 2
def roots(a):
    '''Solve.'''
    return np.linalg.eigvals(a)
def _inner(a): return scipy.fft.fft(a)
def _outer(a): return _inner(a)
def spectrum(a):
    '''Compute. Source: thesis Eq. 2.14.'''
    return _outer(a)
class Fit:
    '''Fit (Nelson, AIAA J. 14 (1976) 1201).'''
    def _step(self): return np.linalg.solve(1, 2)
    def run(self): return self._step()
class Other:
    def run(self):
        '''Run. Source: own derivation: halves.'''
        return scipy.special.gamma(2)
"""
    assert functions_with_source(source) == {"roots": False, "spectrum": True, "Fit.run": True, "Other.run": True}


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
def test_sources_are_distinguished_from_words(docstring: str, due: bool, given: bool) -> None:
    source = f'"""{docstring}"""\n'
    assert (is_due(source), is_given(source)) == (due, given)
    assert is_due(f"{source}import scipy.linalg\n")
