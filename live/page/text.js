// Numbers as text, and text into the page.

/// Writes only changes: every write makes the browser lay out the text again.
export function setText(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}

/// A number with as many digits as its size needs; − is a minus sign.
export function short(value) {
  if (!Number.isFinite(value)) {
    return Number.isNaN(value) ? "–" : value > 0 ? "∞" : "−∞";
  }
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e6 || size < 1e-3) ? value.toExponential(1)
    : size >= 1000 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(3)));
  return text.replace("-", "−");
}

/// For ticks: 20k in place of 20,000.
export function compact(value) {
  const [unit, name] = Math.abs(value) >= 1e6 ? [1e6, "M"] : Math.abs(value) >= 1e4 ? [1e3, "k"] : [1, ""];
  return `${short(value / unit)}${name}`;
}

export function fixed(value, digits) {
  return Number.isFinite(value) ? value.toFixed(digits).replace("-", "−") : "–";
}

/// "1 node", "2,000 nodes"
export function counted(number, noun) {
  return `${number.toLocaleString("en")} ${noun}${number === 1 ? "" : "s"}`;
}
