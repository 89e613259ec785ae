// Field paths into decoded messages (docs/messages.md), and what the fields of ROS messages are.

const FIELDS = {
  ranges: ["range", "m"], range: ["range", "m"], position: ["position", "m"], translation: ["position", "m"],
  linear: ["velocity", "m/s"], angular: ["angular velocity", "rad/s"],
  linear_acceleration: ["acceleration", "m/s²"], angular_velocity: ["angular velocity", "rad/s"],
  force: ["force", "N"], torque: ["torque", "N m"],
  "jointstate.position": ["joint position", "rad or m"],
  "jointstate.velocity": ["joint velocity", "rad/s or m/s"], "jointstate.effort": ["effort", "N m or N"],
  illuminance: ["illuminance", "lux"], temperature: ["temperature", "°C"], fluid_pressure: ["pressure", "Pa"],
  magnetic_field: ["magnetic field", "T"],
};
const USUAL = {
  twist: ["linear.x", "angular.z"],
  odometry: ["pose.pose.position.x", "pose.pose.position.y", "pose.pose.position.z"],
};

/// {quantity, unit} of a field such as "twist.twist.linear.x"; message: type with or without package.
export function ofField(message, path) {
  const type = message.split("/").at(-1).toLowerCase();
  for (const word of path.toLowerCase().replaceAll("[", ".").split(".").reverse()) {
    const found = FIELDS[`${type}.${word}`] ?? FIELDS[word];
    if (found) {
      return { quantity: found[0], unit: found[1] };
    }
  }
  return { quantity: "value", unit: "" };
}

function parsed(written) {
  try {
    return typeof written === "string" ? JSON.parse(written || "null") : written;
  } catch {
    return null;
  }
}

/// The fields of a ros_command: [{path, quantity, unit, low, high}], one for each channel of its command.
export function commandFields(node) {
  const limits = parsed(node.limits) ?? {};
  return Object.keys(parsed(node.fields) ?? {}).flatMap((path) => {
    const [low, high] = Array.isArray(limits[path]) ? limits[path] : [];
    return slice(path).map((each) => ({ path: each, ...ofField(node.message ?? "", path), low, high }));
  });
}

/// "data[0:3]" is data[0], data[1] and data[2].
function slice(path) {
  const found = /^(.*)\[(\d*):(\d+)\](.*)$/.exec(path);
  if (!found) {
    return [path];
  }
  const first = Number(found[2] || 0);
  return Array.from({ length: Number(found[3]) - first }, (_, i) => `${found[1]}[${first + i}]${found[4]}`);
}

/// Channels of a sensor: [{path, quantity, unit}], or null when their number does not match.
export function sensorFields(node, width, world) {
  const type = (node.message ?? "").split("/").at(-1).toLowerCase();
  const written = parsed(node.fields);
  const entries = Array.isArray(written) ? written.map((entry) => (entry.path ? entry : { path: String(entry) }))
    : (USUAL[type] ?? []).slice(0, width).map((path) => ({ path }));
  if (type === "laserscan" && !entries.length) {
    const range = { quantity: "range", unit: "−1 near, 1 far" };
    return Array.from({ length: width }, (_, i) => ({ path: `beam ${i}`, ...range }));
  }
  if (type === "float64multiarray" && width === 2 && node.topic === "/light" && world?.lamps?.length) {
    return ["left", "right"].map((path) => ({ path, quantity: "illuminance", unit: "lux" }));
  }
  if (type === "float64multiarray" && width === 2 && node.topic === "/lane" && world?.lanes?.length) {
    return [["distance", "m"], ["angle", "rad"]].map(([path, unit]) => ({ path, quantity: path, unit }));
  }
  const channels = entries.flatMap((entry) => slice(entry.path).map((path) => {
    const converted = ["scale", "offset", "range"].some((key) => key in entry);
    const { quantity, unit } = ofField(type, path);
    return { path: path.replace("pose.pose.position.", ""), quantity, unit: converted ? "" : unit };
  }));
  return channels.length === width ? channels : null;
}

/// The number at a path; NaN if the message has none.
export function readField(message, path) {
  let value = message;
  for (const part of path.split(/\.(?![^[]*\])/)) {
    const found = /^(\w+)(?:\[([^\]]*)\])?$/.exec(part);
    value = value?.[found?.[1]];
    if (value === undefined) {
      return NaN;
    }
    if (found[2] !== undefined) {
      const [key, text] = found[2].split("=");
      if (text === undefined) {
        value = value[Number(key)];
      } else if (Array.isArray(message[key]) && typeof message[key][0] === "string") {
        value = value[message[key].indexOf(text)];  // position[name=left]
      } else {
        value = [...value].find((each) => each[key] === text);
      }
    } else if (Array.isArray(value) && typeof value[0] === "object") {
      [value] = value;
    }
  }
  return value === undefined ? NaN : Number(value);
}
