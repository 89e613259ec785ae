// Decodes messages of ROS 1 and ROS 2 (XCDR1) by their definition. Times become seconds, int64 a number
// (exact up to 2^53), arrays of numbers typed arrays.

import { parseSchema, sizeOf } from "./schema.js";

const ARRAYS = {
  bool: Uint8Array, byte: Uint8Array, char: Uint8Array, int8: Int8Array, uint8: Uint8Array,
  int16: Int16Array, uint16: Uint16Array, int32: Int32Array, uint32: Uint32Array,
  int64: BigInt64Array, uint64: BigUint64Array, float32: Float32Array, float64: Float64Array,
};
const TEXT = new TextDecoder();

/// A function from the bytes of a message (Uint8Array) to an object. It throws on damaged messages.
export function makeDecoder(channel) {
  const cdr = channel.encoding === "cdr";
  if (!cdr && channel.encoding !== "ros1") {
    throw new Error(`unknown encoding '${channel.encoding}'`);
  }
  const { fields } = parseSchema(channel.schemaName, channel.schema, cdr);
  return (bytes) => readFields(fields, new Reader(bytes, cdr));
}

class Reader {
  constructor(bytes, cdr) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.cdr = cdr;
    this.at = 0;
    this.little = true;
    if (cdr) {
      if (bytes.length < 4 || bytes[0] !== 0 || bytes[1] > 1) {
        throw new Error("not plain CDR");
      }
      this.little = bytes[1] === 1;
      this.at = 4;
    }
  }

  align(size) {
    if (this.cdr) {
      this.at = 4 + Math.ceil((this.at - 4) / size) * size;  // counted from behind the header
    }
  }

  /// The place of the next `size` bytes.
  take(size) {
    const at = this.at;
    this.at += size;
    if (this.at > this.bytes.length) {
      throw new Error("message is too short");
    }
    return at;
  }

  number(type) {
    this.align(sizeOf(type));
    const { view, little } = this;
    const at = this.take(sizeOf(type));
    switch (type) {
      case "bool": return view.getUint8(at) !== 0;
      case "int8": return view.getInt8(at);
      case "int16": return view.getInt16(at, little);
      case "uint16": return view.getUint16(at, little);
      case "int32": return view.getInt32(at, little);
      case "uint32": return view.getUint32(at, little);
      case "int64": return Number(view.getBigInt64(at, little));
      case "uint64": return Number(view.getBigUint64(at, little));
      case "float32": return view.getFloat32(at, little);
      case "float64": return view.getFloat64(at, little);
      default: return view.getUint8(at);  // uint8, byte, char
    }
  }

  text() {
    const size = this.number("uint32");
    const at = this.take(size);
    const end = this.cdr && size > 0 ? at + size - 1 : at + size;  // without the zero byte of CDR
    return TEXT.decode(this.bytes.subarray(at, end));
  }

  time(type) {
    const seconds = this.number(this.cdr || type === "duration" ? "int32" : "uint32");
    return seconds + 1e-9 * this.number(type === "duration" && !this.cdr ? "int32" : "uint32");
  }

  numbers(type, count) {
    const Type = ARRAYS[type], size = sizeOf(type);
    if (count === 0) {
      return new Type(0);  // nothing to align
    }
    this.align(size);
    const at = this.take(count * size);
    if (!this.little && size > 1) {
      const found = new Type(count);
      this.at = at;
      for (let i = 0; i < count; ++i) {
        const value = this.number(type);
        found[i] = size === 8 && !type.startsWith("float") ? BigInt(value) : value;
      }
      return found;
    }
    const begin = this.bytes.byteOffset + at;  // a copy: a view would need an aligned place
    return new Type(this.bytes.buffer.slice(begin, begin + count * size));
  }
}

function readFields(fields, reader) {
  const message = {};
  for (const field of fields) {
    message[field.name] = field.array ? readArray(field, reader) : readOne(field, reader);
  }
  return message;
}

function readOne(field, reader) {
  if (field.nested) {
    return readFields(field.nested, reader);
  }
  if (field.type === "string") {
    return reader.text();
  }
  if (field.type === "time" || field.type === "duration") {
    return reader.time(field.type);
  }
  if (!sizeOf(field.type)) {
    throw new Error(`the definition has no type '${field.type}'`);
  }
  return reader.number(field.type);
}

function readArray(field, reader) {
  const count = field.count ?? reader.number("uint32");
  if (sizeOf(field.type)) {
    return reader.numbers(field.type, count);
  }
  if (count > reader.bytes.length - reader.at) {
    throw new Error("message is too short");  // every element has a byte at least
  }
  return Array.from({ length: count }, () => readOne(field, reader));
}
