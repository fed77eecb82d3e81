"""Verify an exported Rerun recording with Rerun's own tools, and compare it with the JSON Lines of the same export.

usage: python read_rrd.py EXPORTED.rrd EXPORTED.jsonl
needs: pip install rerun-sdk==0.36.3

Prints how many numbers agreed; ends with an error at the first that does not.
"""
import json
import subprocess
import sys
from pathlib import Path

from exported_lines import of_experts, one, single, topic_of
from rerun.experimental import RrdReader

TIMELINES = {"step", "t", "stamp"}


def expected(line):
    """Entity and numbers of everything that a line of JSON and the recording both say."""
    root = "/" + topic_of(line["model"])
    yield from of_experts(line, f"{root}/experts/")
    yield f"{root}/belief/mean", line["posterior"]["mean"]
    yield f"{root}/belief/log_var", line["posterior"]["log_var"]
    position = line["position"]
    yield f"{root}/readings/nees", one(position["nees"])
    for what in ("belief", "prediction"):
        yield f"{root}/readings/{what}_x_m", one(position[what] and position[what]["x"])
        yield f"{root}/readings/{what}_error_m", one(position[f"{what}_error_m"])
        yield f"{root}/readings/psnr_{what}_db", one(line["frames"][f"psnr_{what}_db"])
        yield f"{root}/frames/{what}", one(line["frames"][f"squared_error_{what}"])
        yield f"/table{root}/{what}/ellipse_1_sigma", one(position[what])
    yield f"/table{root}/prediction/plate", one(position["prediction"])


def rows(chunk):
    """Step, stamp and one component of each row; lists, since a row may have several values, or none."""
    batch = chunk.to_record_batch()
    names = [name for name in batch.schema.names if ":" in name]
    steps = batch.column("step").cast("int64").to_pylist()
    stamps = batch.column("stamp").cast("int64").to_pylist()
    # A box without a size is no box; one with a size and nothing else is drawn at the origin.
    name = "Boxes3D:half_sizes" if "Boxes3D:centers" in names else names[0]
    values = batch.column(name).to_pylist()
    return zip(steps, stamps, values)


def read(reader, entry):
    """Everything temporal of one recording, by entity and stamp, and its properties."""
    found, properties, described = {}, {}, set()
    for chunk in reader.store(store=entry).stream().to_chunks():
        path = str(chunk.entity_path)
        if path.startswith("/__properties"):
            batch = chunk.to_record_batch()
            for name, column in zip(batch.schema.names, batch.columns):
                properties[name] = column.to_pylist()
        elif chunk.is_static:
            described.add(path)
        else:
            assert TIMELINES == set(chunk.timeline_names), f"{path} is on {chunk.timeline_names}"
            for step, stamp, value in rows(chunk):
                found.setdefault((path, stamp), (step, value))
    return found, properties, described


def main(recording, lines):
    rerun = Path(sys.executable).with_name("rerun")
    subprocess.run([rerun, "rrd", "verify", recording], check=True, capture_output=True)
    with open(lines, encoding="utf-8") as file:
        lines = [json.loads(line) for line in file]
    reader = RrdReader(recording)
    assert len(reader.blueprints()) >= 1, "no layout"
    stores = {}
    for entry in reader.recordings():
        found, properties, described = read(reader, entry)
        [episode] = properties["episode"][0]
        stores[episode] = (found, properties, described)
    assert set(stores) == {line["episode"] for line in lines}
    agreed = 0
    for line in lines:
        found, properties, described = stores[line["episode"]]
        assert "/about" in described
        stamp = line["stamp_ns"]
        _, [truth] = found["/recorded/frame", stamp]
        for entity, wanted in expected(line):
            step, has = found.get((entity, stamp), (line["step"], None))
            assert step == line["step"], f"{entity}: step {step} at {stamp}"
            if entity.startswith("/table/"):
                assert bool(has) == (wanted is not None), f"{entity} at {stamp}"
                continue
            if entity.split("/")[2] == "frames":
                # The pictures are those that the numbers are of.
                assert bool(has) == (wanted is not None), f"{entity} at {stamp}"
                if wanted is not None:
                    total = sum((a - b) ** 2 for a, b in zip(has[0], truth)) / 255.0**2
                    assert abs(total - wanted[0]) <= 1e-5 * wanted[0], f"{entity} at {stamp}"
                    agreed += 1
                continue
            if wanted is None:
                assert has is None, f"{entity} at {stamp}: {has} where nothing is known"
                continue
            assert has == [single(number) for number in wanted], f"{entity} at {stamp}"
            agreed += len(wanted)
        origin = line["provenance"]
        for key, value in (
            ("data_hash", origin["data_hash"]),
            ("version", origin["poescope"]),
            ("seed", str(origin["seed"])),
        ):
            assert properties[key] == [[value]], f"{key}: {properties[key]}"
    print(f"{agreed} numbers of {len(lines)} steps agree")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
