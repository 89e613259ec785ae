// Reads the text of a ROS message definition (ros1msg, ros2msg) into a list of fields.

const SIZES = {
  bool: 1, byte: 1, char: 1, int8: 1, uint8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4,
  int64: 8, uint64: 8, float32: 4, float64: 8,
};
const FIELD = /^([A-Za-z][\w/]*)(<=\d+)?(\[(<=)?(\d*)\])?\s+([A-Za-z]\w*)\s*(.*)$/;
// Definitions of ROS 2 may leave these two out, as every tool knows them.
const KNOWN = {
  "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
  "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
};

/// The number of bytes of a number, or undefined.
export function sizeOf(type) {
  return SIZES[type];
}

/// {fields, types}: the fields of the message, and those of every type in it by name.
export function parseSchema(name, text, ros2) {
  const types = new Map();
  const root = shortName(name);
  let current = root, lines = [];
  const close = () => types.set(current, parseFields(lines, current, ros2));
  for (const line of text.split(/\r?\n/)) {
    const section = /^MSG:\s*(\S+)/.exec(line);
    if (section) {
      close();
      [current, lines] = [shortName(section[1]), []];
    } else if (!/^=+\s*$/.test(line)) {
      lines.push(line);
    }
  }
  close();
  for (const [known, definition] of Object.entries(KNOWN)) {
    if (!types.has(known)) {
      types.set(known, parseFields(definition.split("\n"), known, ros2));
    }
  }
  resolve(types);
  return { fields: types.get(root), types };
}

/// "pkg/msg/Type" is the same as "pkg/Type".
function shortName(name) {
  return name.replace("/msg/", "/");
}

function parseFields(lines, owner, ros2) {
  const fields = [];
  for (const line of lines) {
    const found = FIELD.exec(line.replace(/#.*$/, "").trim());
    if (!found || found[7].startsWith("=")) {
      continue;  // empty, or a constant, which is not in the message
    }
    const [, type, , array, bounded, count, name] = found;
    fields.push({
      name, type, owner,
      array: array !== undefined,
      count: array !== undefined && !bounded && count !== "" ? Number(count) : undefined,
    });
  }
  if (ros2 && fields.length === 0) {
    // IDL knows no empty structure: a byte stands in it.
    fields.push({ name: "structure_needs_at_least_one_member", type: "uint8", owner, array: false });
  }
  return fields;
}

/// Replaces names relative to their package, and Header, by the names of the sections.
function resolve(types) {
  for (const fields of types.values()) {
    for (const field of fields) {
      if (SIZES[field.type] || ["string", "time", "duration"].includes(field.type)) {
        continue;
      }
      const written = shortName(field.type);
      const choices = [written, `${field.owner.split("/")[0]}/${written}`,
                       ...(written === "Header" ? ["std_msgs/Header"] : [])];
      field.type = choices.find((choice) => types.has(choice)) ?? written;
      field.nested = types.get(field.type);
    }
  }
}
