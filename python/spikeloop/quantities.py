"""What the numbers of a ROS message are: quantity, unit and name of each channel of a sensor or command."""

import json
import math

# Messages of ROS have SI units (REP 103). The last word of a field's path that stands here says what the
# number is; some words mean different things in different messages.
FIELDS = {
    "ranges": ("range", "m"),
    "range": ("range", "m"),
    "position": ("position", "m"),
    "translation": ("position", "m"),
    "linear": ("velocity", "m/s"),
    "angular": ("angular velocity", "rad/s"),
    "linear_acceleration": ("acceleration", "m/s²"),
    "angular_velocity": ("angular velocity", "rad/s"),
    "force": ("force", "N"),
    "torque": ("torque", "N m"),
    "jointstate.position": ("joint position", "rad or m"),
    "jointstate.velocity": ("joint velocity", "rad/s or m/s"),
    "jointstate.effort": ("effort", "N m or N"),
    "illuminance": ("illuminance", "lux"),
    "temperature": ("temperature", "°C"),
    "fluid_pressure": ("pressure", "Pa"),
    "magnetic_field": ("magnetic field", "T"),
}
# Arrays of the simulated robot, which have no fields that say it: what its world has, and their channels.
ARRAYS = {"/light": ("lamps", {"left": FIELDS["illuminance"], "right": FIELDS["illuminance"]}),
          "/lane": ("lanes", {"distance": ("distance", "m"), "angle": ("angle", "rad")})}
UNKNOWN = ("value", "")
POTENTIAL = ("membrane\npotential", "mV")
NORMALISED_RANGE = ("range\n(−1: near, 1: far)", "")
# What a type gives without the key `fields`: as many of them as there are channels.
USUAL_FIELDS = {"twist": ("linear.x", "angular.z"),
                "odometry": ("pose.pose.position.x", "pose.pose.position.y", "pose.pose.position.z")}


def of_field(message, path):
    """Quantity and unit of a field such as "twist.twist.linear.x" of a message type without its package."""
    for word in reversed(path.lower().replace("[", ".").split(".")):
        found = FIELDS.get(f"{message}.{word}") or FIELDS.get(word)
        if found:
            return found
    return UNKNOWN


def describe(signal, message, keys, world):
    """Gives a signal of a sensor or command its quantities and names, and a laser the angles of its beams.

    message: type of the message. keys: of the node or section. world: world.json, {} without one.
    """
    message = message.rsplit("/", 1)[-1].lower()
    fields = _fields(keys.get("fields")) or [
        (path, False) for path in signal.channels or USUAL_FIELDS.get(message, ())[:signal.width]]
    if message == "laserscan" and not fields:
        signal.quantities = [NORMALISED_RANGE] * signal.width
        signal.beams = None if keys.get("beams") else _beams(signal.width, world)
    elif len(fields) == signal.width:
        found = [of_field(message, path) for path, _ in fields]
        signal.quantities = [(quantity, "" if converted else unit)
                             for (quantity, unit), (_, converted) in zip(found, fields)]
        signal.channels = [path.removeprefix("pose.pose.position.") for path, _ in fields]
    elif message == "float64multiarray":
        needed, channels = ARRAYS.get(keys.get("topic") or keys.get("ros_topic"), ("", {}))
        if world.get(needed):
            signal.quantities, signal.channels = list(channels.values()), list(channels)


def _fields(written):
    """Pairs of the path of a sensor's field, and whether its numbers are scaled or mapped to [-1, 1]."""
    try:
        entries = json.loads(written or "[]")
    except ValueError:
        entries = [path.strip() for path in written.split(",")]  # of a .music file
    if not isinstance(entries, list):
        return []  # those of a command; its recording has their names
    maps = [entry if isinstance(entry, dict) else {"path": entry} for entry in entries]
    return [(str(entry.get("path")), bool({"scale", "offset", "range"} & set(entry))) for entry in maps]


def command_channels(written):
    """Pairs of a field and its channel, of the key `fields` of a command: {"linear.x": {"channel": 0}}."""
    fields = json.loads(written or "{}")
    return [(path, to["channel"] if isinstance(to, dict) else to) for path, to in fields.items()]


def _beams(count, world):
    """Angle of the first beam and between beams (degrees). A scan longer than the port is cropped at its end."""
    laser = world.get("laser")
    if not laser or not 1 < count <= laser["beams"]:
        return None
    return tuple(math.degrees(laser[name]) for name in ("angle_min_rad", "angle_increment_rad"))
