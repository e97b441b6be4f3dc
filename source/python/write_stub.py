# SPDX-License-Identifier: MIT
"""write_stub.py FOLDER TEMPLATE OUTPUT: writes the stub of the package `gnomon` in FOLDER.

Lines "# properties of CLASS [without NAME]" and "# values of ENUM" of the template become those of the module.
"""
import re
import sys

# Types of values that may be assigned, by the type that is read. All other types are the same in both directions.
ACCEPTED = {"Vector": "Sequence[float]", "list[Mesh]": "Sequence[Mesh]", "NDArray[np.float64]": "ArrayLike"}


def properties(types, is_dictionary):
    for name, read in types.items():
        accepted = ACCEPTED.get(read, read)
        if is_dictionary:
            yield f"{name}: {accepted}"
        elif read.startswith("NDArray"):
            yield f"@property\n    def {name}(self) -> {read}: ..."
            yield f"@{name}.setter\n    def {name}(self, value: {accepted}) -> None: ..."
        else:
            yield f"{name}: {read}"


def main(folder, template, output):
    sys.path.insert(0, folder)
    sys.dont_write_bytecode = True
    import gnomon

    lines = []
    is_dictionary = False
    with open(template, encoding="utf-8") as file:
        for line in file.read().splitlines():
            if line.startswith("class "):
                is_dictionary = "TypedDict" in line or "Properties(" in line
            of_values = re.fullmatch(r"    # values of (\w+)", line)
            of_properties = re.fullmatch(r"    # properties of (\w+)(?: without (\w+))?", line)
            if of_values:
                lines += [f"    {name}: {of_values[1]}" for name in getattr(gnomon, of_values[1]).__members__]
            elif of_properties:
                types = dict(getattr(gnomon._gnomon, of_properties[1]).__annotations__)
                types.pop(of_properties[2], None)
                lines += [f"    {text}" for text in properties(types, is_dictionary)]
            else:
                lines.append(line)
    with open(output, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


main(*sys.argv[1:])
