"""What a line of exported JSON says, for the scripts that look for the same numbers in other formats."""
import struct


def single(number):
    """The 32-bit float that the text of a number stands for, as the 64-bit one that it is sent as."""
    return struct.unpack("f", struct.pack("f", number))[0]


def topic_of(model):
    """What a model's topics are named after."""
    return "_".join("".join(c if c.isalnum() else " " for c in model).split()).lower()


def one(number):
    """A list of it, if it is known."""
    return None if number is None else [number]


def of_experts(line, root):
    """Name, below `root`, and values of what is known of each expert."""
    for expert in line["experts"] + [line["prior"]]:
        who = root + expert["name"]
        for key in ("mean", "log_var", "share"):
            yield f"{who}/{key}", expert[key]
        for key in ("alpha", "share_mean", "share_position", "information_nats", "mahalanobis"):
            yield f"{who}/{key}", one(expert[key])
        nis = expert["nis"] or {}
        yield f"{who}/nis_head", one(nis.get("head"))
        yield f"{who}/nis_propagated", one(nis.get("propagated"))
