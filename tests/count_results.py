#!/usr/bin/env python3
"""Counts what ctest ran: count_results.py JUNIT RESULTS STATUS [CI]. RESULTS holds a file of gtest's per suite.

Prints passed, failed and skipped on stdout, and on stderr what failed, test by test; writes RESULTS/times.txt.
count_results.py --self-test counts a made-up run of every kind of result.
"""
import contextlib
import fnmatch
import io
import re
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def say(text):
    print(text, file=sys.stderr)


def shortened(text):
    lines = text.strip().split("\n")
    return "\n".join(lines if len(lines) <= 60 else lines[:30] + ["[...]"] + lines[-30:])


def read(path):
    try:
        return ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError):
        return None


def patterns(name):
    """The lines of a list of tests."""
    with open(Path(__file__).parent / name, encoding="utf-8") as file:
        return [line.strip() for line in file if line.strip() and not line.startswith("#")]


def cases_of(results, suite):
    """(name, passed, failed or skipped, seconds, what was said) of each test of a suite; None where no file says so."""
    root = read(results / f"{suite}.xml")
    if root is None:
        return None
    cases = []
    for case in root.iter("testcase"):
        failures = case.findall("failure")
        result = "failed" if failures else "skipped" if case.get("result") != "completed" else "passed"
        said = "\n".join(failure.text or failure.get("message", "") for failure in failures)
        name = f"{suite.split('.')[0]}.{case.get('classname')}.{case.get('name')}"
        cases.append((name, result, float(case.get("time")), said))
    return cases


def running(output):
    """The test that a program broke off in."""
    begun = [line.split("]", 1)[1].strip() for line in output.split("\n") if line.startswith("[ RUN ")]
    return f", in {begun[-1]}" if begun else ""


def main(junit, results, status, ci):
    tests = []
    entries = read(junit)
    for entry in entries.iter("testcase") if entries is not None else []:
        name, output = entry.get("name"), entry.findtext("system-out", "")
        of_gtest = cases_of(Path(results), name)
        cases = of_gtest or []
        skip = entry.find("skipped")
        # A program that is not there is "notrun" too: only what a test says of itself is a skip.
        skipped = entry.get("status") == "disabled" or (
            skip is not None and skip.get("message", "").startswith("SKIP_"))
        passed = entry.get("status") == "run"
        if not passed and not skipped and not any(case[1] == "failed" for case in cases):
            cases.append((name + running(output), "failed", float(entry.get("time")), output))
        elif of_gtest is None:  # not a program of gtest's
            cases.append((name, "passed" if passed else "skipped", float(entry.get("time")), ""))
        tests += cases
    failed = [case for case in tests if case[1] == "failed"]
    for name, _, seconds, said in failed[:20]:
        say(f"-------- FAILED {name}, {seconds:.1f} s --------\n{shortened(said)}")
    regression = patterns("regression_tests.txt")
    for case in failed:
        named = any(fnmatch.fnmatchcase(case[0].split(".", 1)[1], pattern) for pattern in regression)
        say(f"FAILED {case[0]}" + (" (its bound is what was measured once: a regression)" if named else ""))
    count = len(failed)
    if int(status) and not failed:
        count = 1
        say(f"FAILED: ctest ended with status {status} and names no failed test")
    gpu = [case for case in tests if case[0].startswith("gpu.")]
    if gpu and all(case[1] == "skipped" for case in gpu):
        say("All tests in tests/gpu were skipped: no OpenGL 4.3 context here.")
        if ci:
            count += 1
            say("FAILED: CI needs a context; Mesa's software OpenGL will do.")
    with open(Path(results) / "times.txt", "w", encoding="utf-8") as file:
        for name, _, seconds, _ in sorted(tests, key=lambda case: -case[2]):
            file.write(f"{seconds:8.2f} {name}\n")
    print(sum(case[1] == "passed" for case in tests), count, sum(case[1] == "skipped" for case in tests))


def self_test():
    """Lists name tests that exist. Two pass, one fails and one skips in a suite; a crash, a program that is not there, a script, an empty suite."""
    text = "\n".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("*/*_test.cpp"))
    for pattern in patterns("slow_tests.txt") + patterns("regression_tests.txt"):
        suite, test = pattern.replace("*", "").split(".")
        suite = suite.split("/")[0]  # of typed tests
        if not re.search(rf"^(TYPED_)?TEST(_F|_P)?\({suite}, {test}" + ("" if "*" in pattern else r"\)"), text, re.M):
            sys.exit(f"count_results --self-test: no test is named {pattern}")
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder)
        case = '<testcase classname="S" name="{}" status="run" result="{}" time="1">{}</testcase>'
        (results / "core.S.xml").write_text("<testsuites><testsuite>" + case.format("A", "completed", "")
                                            + case.format("B", "completed", "") + case.format("C", "skipped", "")
                                            + case.format("D", "completed", '<failure message="1 is not 2"/>')
                                            + "</testsuite></testsuites>", encoding="utf-8")
        (results / "core.Empty.xml").write_text("<testsuites/>", encoding="utf-8")
        entry = '<testcase name="{}" status="{}" time="1">{}</testcase>'
        (results / "junit.xml").write_text(
            "<testsuite>" + entry.format("core.S", "fail", "") + entry.format("core.Empty", "run", "")
            + entry.format("core.Crash", "fail", "<system-out>[ RUN      ] Crash.Here\n</system-out>")
            + entry.format("core.NotBuilt", "notrun", '<skipped message="Unable to find executable"/>')
            + entry.format("package.Consumer", "run", "")
            + entry.format("package.Off", "notrun", '<skipped message="SKIP_RETURN_CODE=77"/>')
            + "</testsuite>", encoding="utf-8")
        printed, said = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(said):
            main(results / "junit.xml", folder, "8", "")
        wanted = ["FAILED core.S.D", "1 is not 2", "FAILED core.Crash, in Crash.Here", "FAILED core.NotBuilt"]
        missing = [text for text in wanted if text not in said.getvalue()]
        if printed.getvalue() != "3 3 2\n" or missing:
            sys.exit(f"count_results --self-test: {printed.getvalue()!r} for '3 3 2'; not named: {missing}")


if sys.argv[1:] == ["--self-test"]:
    self_test()
else:
    main(*sys.argv[1:4], sys.argv[4] if len(sys.argv) > 4 else "")
