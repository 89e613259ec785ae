// Pictures of cameras (sensor_msgs/Image, sensor_msgs/CompressedImage) as an inset of the world.

import { setText } from "./text.js";

// Bytes of a pixel, and where its red, green and blue are.
const ENCODINGS = {
  rgb8: [3, 0, 1, 2], bgr8: [3, 2, 1, 0], rgba8: [4, 0, 1, 2], bgra8: [4, 2, 1, 0], mono8: [1, 0, 0, 0], "8UC1": [1, 0, 0, 0],
};

export class Pictures {
  constructor(model) {
    this.model = model;
    this.button = document.getElementById("picture");
    this.canvas = document.getElementById("picture-canvas");
    this.note = document.getElementById("picture-note");
    this.button.addEventListener("click", () => {
      this.button.dataset.big = this.button.dataset.big === "yes" ? "no" : "yes";
    });
    this.busy = false;
    this.shown = 0;
  }

  reset() {
    this.button.hidden = true;
  }

  async draw() {
    const picture = this.model.picture;
    if (!picture || picture.drawn || this.busy) {
      return;
    }
    picture.drawn = true;
    this.busy = true;  // one at a time; of several that wait the newest is drawn
    try {
      const image = picture.message.encoding === undefined
        ? await createImageBitmap(new Blob([picture.message.data])) : raw(picture.message);
      const { canvas } = this;
      if (canvas.width !== image.width || canvas.height !== image.height) {
        [canvas.width, canvas.height] = [image.width, image.height];
      }
      const context = canvas.getContext("2d");
      if (image instanceof ImageData) {
        context.putImageData(image, 0, 0);
      } else {
        context.drawImage(image, 0, 0);
        image.close();
      }
      this.shown += 1;
      this.button.hidden = false;
      setText(this.note, `${picture.topic}  ${canvas.width} × ${canvas.height}`);
    } catch (error) {
      this.model.fail(`${picture.topic}: ${error.message || "the picture cannot be read"}`);
    } finally {
      this.busy = false;
    }
  }
}

function raw({ width, height, step, encoding, data }) {
  const [bytes, red, green, blue] = ENCODINGS[encoding] ?? [];
  if (!bytes) {
    throw new Error(`encoding '${encoding}' is not shown`);
  }
  const stride = step || width * bytes;
  if (!width || !height || data.length < stride * (height - 1) + width * bytes) {
    throw new Error("the picture has too few bytes");
  }
  const image = new ImageData(width, height);
  for (let y = 0, to = 0; y < height; ++y) {
    for (let x = 0, at = y * stride; x < width; ++x, at += bytes, to += 4) {
      image.data[to] = data[at + red];
      image.data[to + 1] = data[at + green];
      image.data[to + 2] = data[at + blue];
      image.data[to + 3] = 255;
    }
  }
  return image;
}
