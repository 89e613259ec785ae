// Where a point of the world lies on the canvas: an orthographic projection, from above or from the side.
//
// view: {x, y, scale, azimuth, elevation}: the point of the floor in the middle (m), pixels a metre, angles (rad).
// A point (x, y, z) lies, from the middle of the canvas, at
//
//   right = scale (dx cos a + dy sin a)                              dx = x - view.x, a = azimuth
//   up    = scale ((dy cos a - dx sin a) sin e + z cos e)            dy = y - view.y, e = elevation
//
// Azimuth 0 looks along y; elevation 90° looks from above, and z has no effect.

/// As a plan: x to the right, y up.
export const FROM_ABOVE = { azimuth: 0, elevation: Math.PI / 2 };

/// [right, up] in pixels.
export function project(view, x, y, z = 0) {
  const [cos, sin] = [Math.cos(view.azimuth), Math.sin(view.azimuth)], dx = x - view.x, dy = y - view.y;
  return [view.scale * (dx * cos + dy * sin),
          view.scale * ((dy * cos - dx * sin) * Math.sin(view.elevation) + z * Math.cos(view.elevation))];
}

/// The point of the floor that lies at [right, up].
export function floorAt(view, right, up) {
  const [cos, sin] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
  const across = right / view.scale, along = up / (view.scale * Math.sin(view.elevation));
  return [view.x + across * cos - along * sin, view.y + across * sin + along * cos];
}

/// The horizontal direction to the viewer, of length 1.
export function toViewer({ azimuth }) {
  return [Math.sin(azimuth), -Math.cos(azimuth)];
}

/// From here on the drawing unit is the metre, in the plane of height z.
export function enter(context, view, width, height, z = 0) {
  const [cos, sin] = [Math.cos(view.azimuth), Math.sin(view.azimuth)], flat = Math.sin(view.elevation);
  const [right, up] = project(view, 0, 0, z);
  context.transform(view.scale * cos, view.scale * sin * flat, view.scale * sin, -view.scale * cos * flat,
                    width / 2 + right, height / 2 - up);
}

/// The view that shows a box [left, bottom, right, top] of the floor, and `high` above it, as large as possible.
export function fitting(box, high, angles, width, height) {
  const plain = { x: 0, y: 0, scale: 1, ...angles };
  const places = [0, 2].flatMap((i) => [1, 3].flatMap((k) => [0, high].map((z) => project(plain, box[i], box[k], z))));
  const [[left, right], [low, top]] = [0, 1].map((axis) => {
    const all = places.map((place) => place[axis]);
    return [Math.min(...all), Math.max(...all)];
  });
  const [x, y] = floorAt(plain, (left + right) / 2, (low + top) / 2);
  return { ...angles, x, y, scale: Math.max(1e-3, Math.min(width / (right - left), height / (top - low))) };
}
