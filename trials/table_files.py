"""Writes one table of results as spreadsheets, other programs and tired people write it, and asks for the analysis.

Usage: python3 table_files.py [OTHER_SEEDLOOP ...]

The table is a Box-Behnken design of three factors with known coefficients. Each case is the same table in
another dress, or with one fault. `meant`: the fit of the table as it stood (`same`), or a refusal that names the
place (`refused`). `got`: what happened; `another fit` is an answer to a question that nobody asked. Output is a
Markdown table, several programs one column each, and a last line that counts. The exit code is 1 where the
first program did otherwise than meant.
"""

import io
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
import zipfile

import runs

FACTORS = "symbol,name,unit,low,high\nA,friction,,0.2,0.4\nB,restitution,,0.3,0.7\nC,speed,rpm,10,30\n"
MIDDLE = (0.3, 0.5, 20)
HALF = (0.1, 0.2, 10)
SCATTER = (0.13, -0.21, 0.08, 0.02, -0.17, 0.24, -0.05, 0.11, -0.09, 0.19, -0.14, 0.03, -0.22, 0.16, -0.07)


def design():
    """Twelve middles of edges and three centre points: rows A, B, C, angle as text."""
    rows = []
    for i, j in itertools.combinations(range(3), 2):
        for a, b in itertools.product((-1, 1), repeat=2):
            point = [0, 0, 0]
            point[i], point[j] = a, b
            rows.append(point)
    rows += [[0, 0, 0]] * 3
    out = []
    for (a, b, c), noise in zip(rows, SCATTER):
        angle = 35.5 + 4.25 * a - 0.5 * b + 2.0 * c + 0.75 * a * c - 1.5 * a * a + 0.25 * c * c + noise
        out.append([f"{m + h * x:g}" for m, h, x in zip(MIDDLE, HALF, (a, b, c))] + [f"{angle:.3f}"])
    return out


HEADER = ["A", "B", "C", "angle"]
ROWS = design()


def table(rows=None, header=None, separator=",", end="\n", comma=False):
    """Text of a table."""
    lines = [header or HEADER, *(rows or ROWS)]
    if comma:
        lines = [[cell.replace(".", ",") for cell in line] for line in lines]
    return end.join(separator.join(line) for line in lines) + end


def cell(value, row=4, column=3):
    """The table with one cell changed; row and column from 0."""
    rows = [[*r] for r in ROWS]
    rows[row][column] = value(rows[row][column]) if callable(value) else value
    return table(rows)


def column(change, header=None):
    """The table with each row changed."""
    return table([change([*r], i) for i, r in enumerate(ROWS)], header)


def workbook(rows, merged="", strings=None, second=None):
    """A workbook as programs write it: rows of cells, numbers as numbers, None as no cell; a cell that begins with < is XML."""
    def cell(row, column, value):
        name = f"{chr(65 + column)}{row}"
        if value is None:
            return ""
        if isinstance(value, str) and value.startswith("<"):
            return value.replace("CELL", name)
        if isinstance(value, (int, float)):
            return f'<c r="{name}"><v>{value!r}</v></c>'
        return f'<c r="{name}" t="inlineStr"><is><t>{value}</t></is></c>'

    def sheet(rows, merged=""):
        body = "".join(
            f'<row r="{r}">' + "".join(cell(r, c, v) for c, v in enumerate(line)) + "</row>" for r, line in enumerate(rows, 1))
        return f'<worksheet xmlns="{main}"><sheetData>{body}</sheetData>{merged}</worksheet>'

    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    sheets = [sheet(rows, merged)] + ([sheet(second)] if second is not None else [])
    names = "".join(f'<sheet name="Sheet{i}" sheetId="{i}" r:id="r{i}"/>' for i in range(1, len(sheets) + 1))
    targets = "".join(
        f'<Relationship Id="r{i}" Type="{relations}/worksheet" Target="worksheets/sheet{i}.xml"/>' for i in range(1, len(sheets) + 1))
    parts = {
        "_rels/.rels": f'<Relationships xmlns="{package}"><Relationship Id="r" Type="{relations}/officeDocument" '
                       'Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{relations}"><sheets>{names}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}">{targets}</Relationships>',
        "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>',
    }
    parts |= {f"xl/worksheets/sheet{i}.xml": text for i, text in enumerate(sheets, 1)}
    if strings is not None:
        parts["xl/sharedStrings.xml"] = strings
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return out.getvalue()


NUMBERS = [[float(c) for c in row] for row in ROWS]


def book(change=lambda row, i: row, header=None, before=(), behind=(), **more):
    """The table as a workbook, each row changed."""
    rows = [[*change([*row], i)] for i, row in enumerate(NUMBERS)]
    return workbook([*before, header or HEADER, *rows, *behind], **more)


def one(value, column=3):
    """The table as a workbook with another cell in its fifth row."""
    def change(row, i):
        row[column] = value(row[column]) if callable(value) and i == 4 else value if i == 4 else row[column]
        return row
    return book(change)


SAME, REFUSED = "same", "refused"
CASES = [
    # Workbooks.
    ("a workbook", book(), SAME),
    ("row numbers from 0 before it, as pandas writes", book(lambda r, i: [i, *r], [None, *HEADER]), SAME),
    ("row numbers from 1 before it", book(lambda r, i: [i + 1, *r], [None, *HEADER]), SAME),
    ("row numbers in another order", book(lambda r, i: [14 - i, *r], [None, *HEADER]), SAME),
    ("a column 'Unnamed: 0'", book(lambda r, i: [i, *r], ["Unnamed: 0", *HEADER]), SAME),
    ("names of the rows without a name", book(lambda r, i: [f"run {i}", *r], [None, *HEADER]), REFUSED),
    ("a title above, marked with #", book(before=[["# drum of Tuesday"], []]), SAME),
    ("a title above", book(before=[["Results of Tuesday"]]), REFUSED),
    ("a merged title above", book(before=[["Results"]], merged='<mergeCells><mergeCell ref="A1:D1"/></mergeCells>'), REFUSED),
    ("a row of units below the names", book(lambda r, i: ["", "", "rpm", "deg"] if i == 0 else r), REFUSED),
    ("units behind the names", book(header=["A", "B", "C [rpm]", "angle (deg)"]), SAME),
    ("a name of two lines", book(header=["A", "B", "C\n[rpm]", "angle"]), SAME),
    ("an empty column between", book(lambda r, i: [*r[:2], None, *r[2:]], ["A", "B", None, "C", "angle"]), SAME),
    ("empty cells behind", book(lambda r, i: [*r, "<c r=\"CELL\" s=\"0\"/>"]), SAME),
    ("an empty row between", book(lambda r, i: r, behind=[[], [None, None]]), SAME),
    ("a row of means below", book(lambda r, i: [i, *r], ["run", *HEADER], behind=[["Mean", 0.3, 0.5, 20.0, 35.0]]), REFUSED),
    ("a sum below the response", book(behind=[[None, None, None, 530.2]]), REFUSED),
    ("a word beside a sum", book(behind=[["Total", None, None, 530.2]]), REFUSED),
    ("notes beside the table", book(lambda r, i: [*r, None, "new belt"] if i == 3 else r), REFUSED),
    ("a date for a number", one('<c r="CELL" t="d"><v>2026-11-25</v></c>'), REFUSED),
    ("a truth value for a number", one('<c r="CELL" t="b"><v>1</v></c>'), REFUSED),
    ("an error for a number", one('<c r="CELL" t="e"><v>#DIV/0!</v></c>'), REFUSED),
    ("a formula without its value", one('<c r="CELL"><f>1+2</f></c>'), REFUSED),
    ("a formula with its value", one(lambda v: f'<c r="CELL"><f>1*{v!r}</f><v>{v!r}</v></c>'), SAME),
    ("a number as text", one(lambda v: f"{v!r}"), SAME),
    ("a number as text with blanks", one(lambda v: f"\u00a0{v!r} "), SAME),
    ("a decimal comma as text", one(lambda v: f"{v!r}".replace(".", ",")), REFUSED),
    ("thousands with a comma as text", one("1,034.5"), REFUSED),
    ("per cent as text", one(lambda v: f"{v!r} %"), REFUSED),
    ("names in two rows", book(header=["A", "B", "C", None], before=[[None, None, None, "angle"]]), REFUSED),
    ("a second sheet with notes", book(second=[["notes"], ["new belt"]]), REFUSED),
    ("an empty second sheet", book(second=[]), SAME),
    ("4 000 000 000 announced texts", book(strings='<sst xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" '
                                                  'count="1" uniqueCount="4000000000"><si><t>a</t></si></sst>'), REFUSED),
    ("row numbers before a CSV table", column(lambda r, i: [str(i), *r], ["Unnamed: 0", *HEADER]), SAME),
    ("a mean below a CSV table", table([[str(i), *r] for i, r in enumerate(ROWS)] + [["mean", "0.3", "0.5", "20", "35"]],
                                       ["run", *HEADER]), REFUSED),
    # The same table in another dress.
    ("as written", table(), SAME),
    ("ends of lines CR LF", table(end="\r\n"), SAME),
    ("ends of lines CR alone", table(end="\r"), SAME),
    ("no end of the last line", table()[:-1], SAME),
    ("UTF-8 with byte order mark", b"\xef\xbb\xbf" + table().encode(), SAME),
    ("UTF-16, little end first", table().encode("utf-16"), SAME),
    ("UTF-16, big end first", b"\xfe\xff" + table().encode("utf-16-be"), SAME),
    ("Latin-1 with a column of names", table([r + ["Müller"] for r in ROWS], HEADER + ["gemessen für"]).encode("latin-1"), SAME),
    ("semicolons", table(separator=";"), SAME),
    ("semicolons and decimal commas", table(separator=";", comma=True), SAME),
    ("tabs", table(separator="\t"), SAME),
    ("tabs and decimal commas", table(separator="\t", comma=True), SAME),
    ("a first line sep=;", "sep=;\n" + table(separator=";", comma=True), SAME),
    ("blanks round every cell", table([[f"  {c} " for c in r] for r in ROWS], [f" {c} " for c in HEADER]), SAME),
    ("every cell in quotes", table([[f'"{c}"' for c in r] for r in ROWS], [f'"{c}"' for c in HEADER]), SAME),
    ("decimal commas in quotes", table([['"' + c.replace(".", ",") + '"' for c in r] for r in ROWS]), REFUSED),
    ("comments before and between", "# of Tuesday\n" + table().replace("\n", "\n# next\n", 3), SAME),
    ("empty lines between and behind", table().replace("\n", "\n\n", 5) + "\n\n", SAME),
    ("rows of commas behind", table() + ",,,\n,,,\n", SAME),
    ("an empty column behind", table([r + [""] for r in ROWS], HEADER + [""]), SAME),
    ("rows in another order", table(ROWS[::-1]), SAME),
    ("columns in another order", table([[r[i] for i in (3, 1, 0, 2)] for r in ROWS], [HEADER[i] for i in (3, 1, 0, 2)]), SAME),
    ("a column of row numbers", column(lambda r, i: [str(i + 1), *r], ["", *HEADER]), SAME),
    ("a column of remarks", column(lambda r, i: [*r, "ok" if i else "new belt, damp"[:8]], [*HEADER, "remark"]), SAME),
    ("remarks of two lines", column(lambda r, i: [*r, '"damp,\nnew belt"'], [*HEADER, "remark"]), SAME),
    ("inch marks in remarks", column(lambda r, i: [*r, '5" belt'], [*HEADER, "remark"]), SAME),
    ("powers of ten", table([[f"{float(c):.6e}" for c in r] for r in ROWS]), SAME),
    ("a sign before each number", table([["+" + c for c in r] for r in ROWS]), SAME),
    # One fault.
    ("an empty cell", cell(""), REFUSED),
    ("NA", cell("NA"), REFUSED),
    ("NaN", cell("NaN"), REFUSED),
    ("inf", cell("inf"), REFUSED),
    ("1e400", cell("1e400"), REFUSED),
    ("a dash for no value", cell("-"), REFUSED),
    ("#DIV/0! of a spreadsheet", cell("#DIV/0!"), REFUSED),
    ("a date of a spreadsheet", cell("35. Feb"), REFUSED),
    ("a mark behind the number", cell(lambda v: v + "*"), REFUSED),
    ("a limit of detection", cell("<30"), REFUSED),
    ("the unit in the cell", cell(lambda v: v + " deg"), REFUSED),
    ("two points", cell(lambda v: v.replace(".", "..")), REFUSED),
    ("the letter O for a zero", cell("3O.5"), REFUSED),
    ("a minus sign of typography", cell(lambda v: "\u2212" + v), REFUSED),
    ("a number of hexadecimal digits", cell("0x23"), REFUSED),
    ("blanks within a number", cell(lambda v: v[0] + " " + v[1:]), REFUSED),
    ("an empty level", cell("", column=0), REFUSED),
    ("a level far outside its range", cell("3", column=0), REFUSED),
    ("a column in per cent", column(lambda r, i: [f"{100 * float(r[0]):g}", *r[1:]]), REFUSED),
    ("two columns exchanged by their names", table(header=["C", "B", "A", "angle"]), REFUSED),
    ("a row too short", table().replace(ROWS[5][-1] + "\n", "\n", 1).replace(",\n", "\n", 1), REFUSED),
    ("a row too long", table().replace(ROWS[5][-1], ROWS[5][-1] + ",1", 1), REFUSED),
    ("a comma for one decimal point", table().replace(ROWS[5][-1], ROWS[5][-1].replace(".", ","), 1), REFUSED),
    ("a column twice", column(lambda r, i: [*r, r[3]], [*HEADER, "angle"]), REFUSED),
    ("a factor is absent", table([r[:2] + r[3:] for r in ROWS], ["A", "B", "angle"]), REFUSED),
    ("the response is absent", table([r[:3] for r in ROWS], HEADER[:3]), REFUSED),
    ("names in small letters", table(header=["a", "b", "c", "angle"]), REFUSED),
    ("a title above the names", "Results of Tuesday\n" + table(), REFUSED),
    ("no names", table(header=ROWS[0]), REFUSED),
    ("nothing", "", REFUSED),
    ("names alone", ",".join(HEADER) + "\n", REFUSED),
    ("five rows for ten terms", table(ROWS[:5]), REFUSED),
    ("a factor that never changes", column(lambda r, i: [r[0], "0.5", *r[2:]]), REFUSED),
    ("two factors always alike", column(lambda r, i: [r[0], f"{0.5 + 2 * (float(r[0]) - 0.3):g}", *r[2:]]), REFUSED),
    ("a response that never changes", column(lambda r, i: [*r[:3], "35"]), REFUSED),
    ("an open quote", cell(lambda v: '"' + v), REFUSED),
    ("a picture", b"\x89PNG\r\n\x1a\n" + bytes(range(256)), REFUSED),
    ("a folder", None, REFUSED),
]


def answer(program, folder, content):
    """Coefficients of the fit, or none, and what was said."""
    path = folder / "results.csv"
    if content is None:
        path.mkdir()
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    words = [program, "analyse", "results.csv", "--factors", "FACTORS.csv", "--response", "angle",
             "--model", "quadratic", "--json", "analysis.json"]
    done = subprocess.run(words, cwd=folder, capture_output=True, timeout=60)
    said = " ".join(done.stderr.decode(errors="replace").split())
    if done.returncode != 0:
        return None, f"exit {done.returncode}: {said}"
    text = json.loads((folder / "analysis.json").read_text())
    return numbers(text.get("terms", text)), said


def numbers(value):
    """All numbers of a JSON value in order."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [number for each in value for number in numbers(each)]
    return [value] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


def alike(found, wanted):
    """Whether two fits agree to the rounding of other orders of the rows."""
    return len(found) == len(wanted) and all(abs(a - b) <= 1e-8 * max(1, abs(b)) for a, b in zip(found, wanted))


def verdict(program, content, wanted):
    """One word, and the message."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "FACTORS.csv").write_text(FACTORS)
        found, said = answer(program, folder, content)
    if found is None:
        placed = "results.csv" in said or "FACTORS" in said
        clean = said.startswith("exit 2") and "panicked" not in said
        return (REFUSED if clean and placed else "refused without its place" if clean else "broken"), said
    return (SAME if wanted is None or alike(found, wanted) else "another fit"), said


def main():
    """Prints the table."""
    programs = [runs.program("seedloop"), *(pathlib.Path(word).resolve() for word in sys.argv[1:])]
    wanted = []
    for program in programs:
        with tempfile.TemporaryDirectory() as name:
            (pathlib.Path(name) / "FACTORS.csv").write_text(FACTORS)
            wanted.append(answer(program, pathlib.Path(name), table())[0])
    print("| table | meant | got |" + " other |" * (len(programs) - 1))
    print("|---|---|---|" + "---|" * (len(programs) - 1))
    right = [0] * len(programs)
    for name, content, meant in CASES:
        got = []
        for k, program in enumerate(programs):
            word, said = verdict(program, content, wanted[k])
            print(f"{name}: {word}: {said}", file=sys.stderr)
            right[k] += word == meant
            got.append(word)
        print(f"| {name} | {meant} | " + " | ".join(got) + " |")
    print(f"\nAs meant: {', '.join(map(str, right))} of {len(CASES)}.")
    sys.exit(int(right[0] < len(CASES)))


main()
