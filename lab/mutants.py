"""Plants random mutants of cargo-mutants, and says by which test each is found.

    python3 lab/mutants.py core=100 readers=60     100 mutants of core/src, 60 of measured/src/read
    python3 lab/mutants.py --table                 the table, docs/figures/mutants.csv

All mutants of a run are compiled at once: a function holds its own body and a mutated copy of it, and the variable SRBF_MUTANT
says which one runs. A first run of all tests writes which test reaches which mutant. Each mutant is then run by those tests, fastest first,
until one fails. A mutant that cannot stand beside the original (constants, `const fn` that a constant calls) is compiled alone, and meets the tests of its package.
The tests are those of PROGRAMS, at the level that the machine has. Left out: code that this processor, or this choice of features, does not compile.

Needs `cargo install --locked cargo-mutants`. Rows go to target/mutants/results.csv. A survivor is judged by hand, in docs/figures/survivors.csv:
`equivalent` with its reason, `closed` with the test that finds it since, or `open`.
"""
import csv
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HOUSE = ROOT / "target" / "mutants"
TREE, BUILD = HOUSE / "tree", HOUSE / "build"
SEED = 66
# Longest run of one test, seconds, beside its seconds without a mutant.
LIMIT = 60
AREAS = {
    "core": ("srbf-core", "core/src/", "crate"),
    "readers": ("srbf-measured", "measured/src/read", "srbf_core"),
}
# Code of other processors, of builds without `simd`, and of tests.
LEFT_OUT = re.compile(
    r"core/src/simd/(sse2|vfp)\.rs|core/src/kernel/(one_lobe|streamed/small)\.rs|measured/src/read/rgl/synthetic\.rs|/tests?\.rs|/tests/"
)
# Programs of tests in the order in which a mutant meets them: areas, packages and programs of one call of cargo.
STAGES = [
    (["core"], ["srbf-core"], ["--lib", "--test=kernels"]),
    (["core"], ["srbf-levels"], ["--test=every_level"]),
    (
        ["core", "readers"],
        ["srbf-measured", "srbf-tests"],
        ["--lib"]
        + ["--test=" + name for name in "completion field_cases formats growth kept_inputs layouts shapes turns".split()]
        + ["--test=" + name for name in
           "library asked anisotropic packed sheets blends agreement expanded environment ends fuzz verbs".split()],
    ),
]
# Tests of the readers say nothing of `core`, and those of `core` nothing of readers.
FOLDERS = {"core": ["core", "levels", "tests"], "readers": ["measured", "tests:fuzz"]}
# No test of these fits: they compile faster.
FASTER = [f"profile.release.package.srbf-{name}.opt-level=1" for name in ["fit", "measured"]]
SWITCH = '''//! Which mutant runs: see lab/mutants.py.
extern crate std;
use core::sync::atomic::{AtomicU32, Ordering};
use std::{cell::Cell, collections::BTreeSet, env, fs, io::Write, string::String, sync::Mutex};
static ACTIVE: AtomicU32 = AtomicU32::new(u32::MAX);
static SEEN: Mutex<BTreeSet<(u32, String)>> = Mutex::new(BTreeSet::new());
/// Whether this mutant runs.
#[inline(always)]
pub fn on(n: u32) -> bool {
    let active = ACTIVE.load(Ordering::Relaxed);
    active == n || active >= u32::MAX - 1 && slow(n)
}
#[cold]
#[inline(never)]
fn slow(n: u32) -> bool {
    if ACTIVE.load(Ordering::Relaxed) == u32::MAX {
        let chosen = env::var("SRBF_MUTANT").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
        ACTIVE.store(if env::var_os("SRBF_REACHED").is_some() { u32::MAX - 1 } else { chosen }, Ordering::Relaxed);
        return on(n);
    }
    // A thread asks once for each mutant.
    std::thread_local! { static ASKED: Cell<[u64; 16]> = const { Cell::new([0; 16]) } }
    let asked = ASKED.try_with(|cell| {
        let (mut words, bit) = (cell.get(), 1 << (n % 64));
        let before = words[n as usize / 64 % 16] & bit != 0;
        words[n as usize / 64 % 16] |= bit;
        cell.set(words);
        before
    });
    if asked.unwrap_or(true) {
        return false;
    }
    let name = String::from(std::thread::current().name().unwrap_or("?"));
    if let Ok(mut seen) = SEEN.lock()
        && seen.insert((n, name.clone()))
        && let Ok(mut file) = fs::OpenOptions::new().append(true).create(true).open(env::var("SRBF_REACHED").unwrap_or_default())
    {
        let _ = file.write_all(std::format!("{n}\\t{name}\\n").as_bytes());
    }
    false
}
'''


def cargo(*arguments, **more):
    environment = dict(os.environ, CARGO_TARGET_DIR=str(BUILD), RUSTFLAGS="--cap-lints=warn", CARGO_INCREMENTAL="1")
    options = [part for option in FASTER for part in ["--config", option]]
    return subprocess.run(["cargo", *arguments, *options], cwd=TREE, env=environment, capture_output=True, text=True, **more)


def fresh_tree():
    """A copy of the files that git knows, as they are now. A file that is the same keeps its time."""
    TREE.mkdir(parents=True, exist_ok=True)
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, names):
        source, copy = ROOT / name, TREE / name
        if source.is_symlink() or not source.is_file():
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        put(copy, source.read_bytes())


def put(path, data):
    if not path.exists() or path.read_bytes() != data:
        path.write_bytes(data)


def chosen(area, count):
    package, folder, _ = AREAS[area]
    text = subprocess.run(["cargo", "mutants", "--list", "--json", "-p", package], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    mutants = [m for m in json.loads(text) if m["file"].startswith(folder) and not LEFT_OUT.search(m["file"])]
    mutants.sort(key=lambda m: m["name"])
    random.Random(SEED).shuffle(mutants)
    print(f"{area}: {count} of {len(mutants)} mutants")
    return [mutant | {"area": area} for mutant in mutants[:count]]


def place(lines, position):
    return sum(len(line) for line in lines[: position["line"] - 1]) + position["column"] - 1


def spliced(text, mutant, start, end):
    """The text from start to end, mutated."""
    lines = text.splitlines(keepends=True)
    first, last = place(lines, mutant["span"]["start"]), place(lines, mutant["span"]["end"])
    return text[start:first] + mutant["replacement"] + text[last:end]


def body_of(text, mutant):
    """Where the body of the mutant's function begins and ends, braces not counted."""
    lines = text.splitlines(keepends=True)
    start, end = place(lines, mutant["function"]["span"]["start"]), place(lines, mutant["function"]["span"]["end"])
    at = re.search(r"^(?:[ \t]*(?:///[^\n]*|//[^\n]*|#\[[^\n]*)\n)*", text[start:end], re.M).end() + start
    opening = text.index("{", at)
    assert text[end - 1] == "}", mutant["name"]
    return at, opening + 1, end - 1


def instrument(mutants, alone):
    """Writes the files with every mutant that is not alone. Returns, for each file, lines of a copy or an original, and whose they are."""
    files, ranges = {}, {}
    for number, mutant in enumerate(mutants, 1):
        if number not in alone:
            files.setdefault(mutant["file"], {}).setdefault(body_of((ROOT / mutant["file"]).read_text(), mutant), []).append(number)
    for name, functions in files.items():
        text, out, last = (ROOT / name).read_text(), "", 0
        for (head, start, end), numbers in sorted(functions.items()):
            # A function within a mutated function: the outer body has it as it is.
            if start < last:
                alone.update({n: "nested" for n in numbers})
                continue
            out += text[last:head] + re.sub(r"\bconst fn\b", "fn", text[head:start])
            first = out.count("\n") + 1
            for n in numbers:
                copy = spliced(text, mutants[n - 1], start, end)
                begin = out.count("\n") + 1
                out += f" if {AREAS[mutants[n - 1]['area']][2]}::mutants::on({n}) {{ {copy} }} else"
                ranges.setdefault(name, []).append((begin, out.count("\n") + 1, [n]))
            out += "{" + text[start:end] + "}"
            ranges[name].append((first, out.count("\n") + 1, numbers))
            last = end
        put(TREE / name, (out + text[last:]).encode())
    put(TREE / "core/src/mutants.rs", SWITCH.encode())
    library = (ROOT / "core/src/lib.rs").read_text() if "core/src/lib.rs" not in files else (TREE / "core/src/lib.rs").read_text()
    put(TREE / "core/src/lib.rs", (library + "\n#[allow(missing_docs)]\npub mod mutants;\n").encode())
    return ranges


def errors(output):
    for line in output.splitlines():
        message = json.loads(line) if line.startswith("{") else {}
        if message.get("reason") == "compiler-message" and message["message"]["level"] == "error":
            spans = [(s["file_name"], s["line_start"]) for s in message["message"]["spans"]]
            yield spans, message["message"]["message"]


def check(areas):
    packages = [part for area in areas for part in ["-p", AREAS[area][0]]]
    return cargo("check", "--release", "--tests", *packages, "--message-format=json")


def compile_together(mutants):
    """Mutants that cannot stand beside the original, with the compiler's reason."""
    alone = {n: "not in a function" for n, m in enumerate(mutants, 1) if m["function"] is None}
    while True:
        fresh_tree()
        ranges = instrument(mutants, alone)
        result = check({m["area"] for m in mutants})
        if result.returncode == 0:
            return alone
        before = len(alone)
        for spans, message in errors(result.stdout):
            for file, line in spans:
                inner = sorted((r for r in ranges.get(file, []) if r[0] <= line <= r[1]), key=lambda r: r[1] - r[0])
                if inner:
                    alone.update({n: message for n in inner[0][2] if n not in alone})
        if len(alone) == before:
            # The error is elsewhere: a constant calls a function that has lost `const`.
            named = {n for n, m in enumerate(mutants, 1) if n not in alone and m["function"]
                     and re.search(r"\bconst fn\b", (ROOT / m["file"]).read_text()[slice(*body_of((ROOT / m["file"]).read_text(), m)[:2])])}
            if not named:
                sys.exit("\n".join(f"{s} {m}" for s, m in errors(result.stdout)) + result.stderr[-3000:])
            alone.update({n: "const fn" for n in named})


def programs(packages, tests):
    """Compiles tests; the path of each program."""
    found = {}
    arguments = [part for package in packages for part in ["-p", package]] + tests
    result = cargo("test", "--release", "--no-run", *arguments, "--message-format=json")
    if result.returncode:
        raise SystemExit(result.stderr[-3000:])
    for line in result.stdout.splitlines():
        message = json.loads(line) if line.startswith("{") else {}
        if message.get("executable") and message["profile"]["test"]:
            folder = Path(message["manifest_path"]).parent
            found[f"{folder.name}:{message['target']['name']}"] = (message["executable"], folder)
    return found


def run(program, tests=(), limit=600, **variables):
    """The result of a program of tests: passed, failed or timeout; and its text."""
    executable, folder = program
    environment = dict(os.environ, RUSTC_BOOTSTRAP="1", CARGO_MANIFEST_DIR=str(folder), CARGO_TARGET_DIR=str(BUILD), **variables)
    command = [executable, "-Zunstable-options", "--report-time", "--test-threads=2", *(["--exact", *tests] if tests else [])]
    try:
        result = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=limit, errors="replace")
    except subprocess.TimeoutExpired:
        return "timeout", ""
    return ("failed" if result.returncode else "passed"), result.stdout + result.stderr


def reached(found):
    """For each mutant, the tests that reach it and their seconds, fastest first."""
    by = {}
    for name, program in found.items():
        log = HOUSE / "reached"
        log.unlink(missing_ok=True)
        result, text = run(program, limit=1500, SRBF_REACHED=str(log))
        times = {m[1]: float(m[3]) for m in re.finditer(r"^test (\S+)( - should panic)? \.\.\. ok <([\d.]+)s>", text, re.M)}
        print(f"{name}: {result}, {sum(times.values()):.0f} s in {len(times)} tests", flush=True)
        if result != "passed":
            print(text[-2000:])
        for line in log.read_text().splitlines() if log.exists() else []:
            number, test = line.split("\t")
            # A thread without a test's name is one of a test, or of a pool: any of the program.
            for which in [test] if test in times else list(times):
                by.setdefault(int(number), {})[name, which] = times[which]
    return {n: sorted(tests.items(), key=lambda item: item[1]) for n, tests in by.items()}


def hunt(number, tests, found):
    """The first test that fails, with groups of a program's tests of similar time run at once."""
    groups, last = [], None
    for (name, test), seconds in tests:
        if last and last[0] == name and last[2] + seconds < 5 and len(last[1]) < 200:
            last[1].append(test)
            last[2] += seconds
        else:
            last = [name, [test], seconds]
            groups.append(last)
    for name, group, seconds in groups:
        result, text = run(found[name], group, LIMIT + 4 * seconds, SRBF_MUTANT=str(number))
        if result == "timeout":
            return "timeout", f"{name} {group[0]}"
        if result == "failed":
            failed = re.search(r"^test (\S+)( - should panic)? \.\.\. FAILED", text, re.M)
            return "killed", f"{name} {failed[1] if failed else group[0]}"
    return "survived", f"{len(tests)} tests reach it"


def hunt_alone(mutant):
    fresh_tree()
    text = (ROOT / mutant["file"]).read_text()
    put(TREE / mutant["file"], spliced(text, mutant, 0, len(text)).encode())
    if check([mutant["area"]]).returncode:
        return "does not compile", ""
    package = AREAS[mutant["area"]][0]
    for tests in ["--lib"], ["--tests"]:
        try:
            found = programs([package], tests)
        except SystemExit:
            return "does not compile", "with its tests"
        for name, program in found.items():
            result, text = run(program, limit=300)
            if result != "passed":
                failed = re.search(r"^test (\S+) \.\.\. FAILED", text, re.M)
                return {"failed": "killed"}.get(result, result), f"{name} {failed[1] if failed else ''}"
    return "survived", "alone: tests of its package"


def main(counts):
    HOUSE.mkdir(parents=True, exist_ok=True)
    mutants = [mutant for area, count in counts.items() for mutant in chosen(area, count)]
    start = time.time()
    alone = compile_together(mutants)
    print(f"{len(mutants) - len(alone)} mutants together, {len(alone)} alone: {time.time() - start:.0f} s", flush=True)
    for number, reason in alone.items():
        print(f"  alone {number}: {mutants[number - 1]['name']}: {reason}")
    results = {}
    open_ones = [n for n in range(1, len(mutants) + 1) if n not in alone]
    for areas, packages, tests in STAGES:
        if not set(areas) & set(counts):
            continue
        found = programs(packages, tests)
        print(f"{packages} compiled: {time.time() - start:.0f} s", flush=True)
        reach = reached(found)
        print(f"its tests once: {time.time() - start:.0f} s", flush=True)
        for number in list(open_ones):
            mutant = mutants[number - 1]
            mine = [test for test in reach.get(number, []) if any(test[0][0].startswith(f) for f in FOLDERS[mutant["area"]])]
            result, by = hunt(number, mine, found)
            if result == "survived":
                results[number] = (result, f"{results.get(number, ('', ''))[1]} {by}".strip())
                continue
            open_ones.remove(number)
            results[number] = (result, by)
            print(f"{number} {result}: {mutant['name']} [{by}]", flush=True)
        print(f"{len(open_ones)} not found: {time.time() - start:.0f} s", flush=True)
        write(mutants, results)
    for number, reason in alone.items():
        result, by = hunt_alone(mutants[number - 1])
        results[number] = (result, by or reason)
        print(f"{number} {result}: {mutants[number - 1]['name']} [{by}] {reason}", flush=True)
        write(mutants, results)
    for number, (result, by) in sorted(results.items()):
        if result == "survived":
            print(f"{number} {result}: {mutants[number - 1]['name']} [{by}]", flush=True)
    print(f"in all: {time.time() - start:.0f} s")


def write(mutants, results):
    with (HOUSE / "results.csv").open("w") as file:
        writer = csv.writer(file)
        writer.writerow(["area", "mutant", "result", "by"])
        writer.writerows([mutants[n - 1]["area"], mutants[n - 1]["name"], *row] for n, row in sorted(results.items()))


def table():
    """The table, of the results and of docs/figures/survivors.csv."""
    results = list(csv.DictReader((HOUSE / "results.csv").open()))
    judged = {row["mutant"]: row["verdict"] for row in csv.DictReader((ROOT / "docs/figures/survivors.csv").open())}
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow("area,mutants,killed,do not compile,timeout,equivalent,gaps closed by a test,open".split(","))
    for area in AREAS:
        mine = [row for row in results if row["area"] == area]
        verdicts = [row["result"] if row["result"] != "survived" else judged.get(row["mutant"], "open") for row in mine]
        kinds = ["killed", "does not compile", "timeout", "equivalent", "closed", "open"]
        writer.writerow([area, len(mine), *(verdicts.count(kind) for kind in kinds)])


if __name__ == "__main__" and sys.argv[1:] == ["--table"]:
    table()
elif __name__ == "__main__":
    main({area: int(count) for area, count in (word.split("=") for word in sys.argv[1:])})
