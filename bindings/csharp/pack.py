#!/usr/bin/env python3
"""pack.py ASSEMBLY PREFIX FOLDER: FOLDER/Pbf.VERSION.nupkg, of the assembly and of libpbf with its backends as
they are installed in PREFIX. A NuGet package is a zip file; `dotnet pack` makes one without the library."""
import pathlib
import re
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parent

NUSPEC = """<?xml version="1.0" encoding="utf-8"?>
<package xmlns="http://schemas.microsoft.com/packaging/2013/05/nuspec.xsd">
  <metadata>
    <id>Pbf</id>
    <version>{version}</version>
    <authors>the pbf authors</authors>
    <description>{description}</description>
    <license type="expression">MIT</license>
    <dependencies><group targetFramework=".NETStandard2.0" /></dependencies>
  </metadata>
</package>
"""
TYPES = """<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
  <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml" />
  <Default Extension="nuspec" ContentType="application/octet" />
  <Default Extension="dll" ContentType="application/octet" />
  <Default Extension="so" ContentType="application/octet" />
  <Default Extension="md" ContentType="application/octet" />
  <Override PartName="/LICENSE" ContentType="application/octet" />
</Types>
"""
RELATIONS = """<?xml version="1.0" encoding="utf-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
  <Relationship Type="http://schemas.microsoft.com/packaging/2010/07/manifest" Target="/Pbf.nuspec" Id="R1" />
</Relationships>
"""
EPOCH = (1980, 1, 1, 0, 0, 0)  # of every entry: the same package from the same files


def property_of(name):
    return re.search(rf"<{name}>(.*?)</{name}>", (HERE / "Pbf/Pbf.csproj").read_text(encoding="utf-8"))[1]


def main(assembly, prefix, folder):
    library = next(pathlib.Path(prefix).rglob("libpbf.so")).resolve()
    native = "runtimes/linux-x64/native/"
    contents = {
        "[Content_Types].xml": TYPES.encode(),
        "_rels/.rels": RELATIONS.encode(),
        "Pbf.nuspec": NUSPEC.format(version=property_of("Version"), description=property_of("Description")).encode(),
        "lib/netstandard2.0/Pbf.dll": pathlib.Path(assembly).read_bytes(),
        native + "libpbf.so": library.read_bytes(),
    }
    # Beside the library is one of the places where it looks for backends, and NuGet keeps no folders there.
    for backend in sorted((library.parent / "pbf/backends").glob("*.so")):
        contents[native + backend.name] = backend.read_bytes()
    for notice in ("LICENSE", "THIRD_PARTY_NOTICES.md"):
        contents[notice] = (HERE.parents[1] / notice).read_bytes()
    package = pathlib.Path(folder) / f"Pbf.{property_of('Version')}.nupkg"
    with zipfile.ZipFile(package, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(zipfile.ZipInfo(name, EPOCH), content, zipfile.ZIP_DEFLATED)
    print(package)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
