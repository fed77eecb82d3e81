"""Compare an exported MCAP with the JSON Lines of the same export, read by the Python `mcap` reader.

usage: python read_exported.py EXPORTED.mcap EXPORTED.jsonl
needs: pip install mcap==1.6.0 mcap-ros2-support==0.6.0

Prints how many numbers agreed; ends with an error at the first that does not.
"""
import json
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from exported_lines import of_experts, one, single, topic_of


def expected(line):
    """Topic and values of everything that a line of JSON and the recording both say."""
    root = f"/poescope/{topic_of(line['model'])}/"
    yield from of_experts(line, root)
    yield root + "belief/mean", line["posterior"]["mean"]
    yield root + "belief/log_var", line["posterior"]["log_var"]
    for what in ("belief", "prediction"):
        at = line["position"][what]
        yield f"{root}position/{what}", at and [at["x"], at["y"], *at["covariance"]]
        for key in ("psnr", "squared_error"):
            name = f"{key}_{what}" + ("_db" if key == "psnr" else "")
            yield root + name, one(line["frames"][name])


def values(message):
    """The numbers of a message."""
    if hasattr(message, "pose"):
        at, covariance = message.pose.pose.position, list(message.pose.covariance)
        planar = {0, 1, 6, 7}
        assert all(c == 0.0 for i, c in enumerate(covariance) if i not in planar)
        assert covariance[1] == covariance[6]
        return [at.x, at.y, covariance[0], covariance[1], covariance[7]]
    data = message.data
    return [data] if isinstance(data, float) else list(data)


def main(recording, lines):
    with open(lines, encoding="utf-8") as file:
        lines = [json.loads(line) for line in file]
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found, images = {}, {}
        for _, channel, logged, message in reader.iter_decoded_messages():
            if channel.topic.endswith(("/image", "/image_raw")):
                stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
                images[channel.topic, stamp] = message
            elif channel.topic.startswith("/poescope/"):
                assert (channel.topic, logged.publish_time) not in found, "said twice"
                found[channel.topic, logged.publish_time] = values(message)
        records = {record.name: record.metadata for record in reader.iter_metadata()}
    agreed = 0
    for line in lines:
        stamp = line["stamp_ns"]
        for topic, wanted in expected(line):
            has = found.get((topic, stamp))
            if wanted is None:
                assert has is None, f"{topic} at {stamp}: {has} where nothing is known"
                continue
            assert has == [single(number) for number in wanted], f"{topic} at {stamp}"
            agreed += len(wanted)
        # The pictures are those that the numbers are of.
        truth = images.get(("/camera/image_raw", stamp))
        for what in ("belief", "prediction"):
            picture = images.get((f"/poescope/{topic_of(line['model'])}/{what}/image", stamp))
            error = line["frames"][f"squared_error_{what}"]
            assert (picture is None) == (error is None)
            if picture is not None:
                assert (picture.width, picture.height) == (truth.width, truth.height)
                total = sum((a - b) ** 2 for a, b in zip(picture.data, truth.data)) / 255.0**2
                assert abs(total - error) <= 1e-5 * error, f"{what} at {stamp}: {total} {error}"
                agreed += 1
    origin = lines[0]["provenance"]
    assert records["poescope"]["data_hash"] == origin["data_hash"]
    assert records["poescope"][f"model.{topic_of(lines[0]['model'])}.hash"] == origin["model_hash"]
    assert records["poescope"]["version"] == origin["poescope"]
    print(f"{agreed} numbers of {len(lines)} steps agree")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
