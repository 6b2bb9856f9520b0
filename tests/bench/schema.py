"""The committed scenes keep to the schema, and the schema to its own: judged by another validator
than the harness's. Skipped (77) where python3-jsonschema is not installed."""

import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("SKIPPED: python3-jsonschema is not installed")
    sys.exit(77)

folder = pathlib.Path(sys.argv[1])
schema = json.loads((folder / "scene.schema.json").read_text())
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)

scenes = [path for path in sorted(folder.rglob("*.json")) if path.name != "scene.schema.json"]
wanted = """report-30k dam-break-3d dam-break-2d shallow-dam-break cube-collapse double-dam-break
drop-into-pool still-tank moving-paddle zero-gravity-drop honey-coil""".split()
missing = set(wanted) - {path.stem for path in scenes}
assert not missing, f"scenes are missing: {missing}"
for path in scenes:
    validator.validate(json.loads(path.read_text()))
print(f"{len(scenes)} scenes keep to the schema")
