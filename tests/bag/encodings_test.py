#!/usr/bin/python3
"""Encodings of images and formats of compressed ones, from a bag that rosbag wrote, against NumPy and Pillow:
as channels of a sensor, and as pixels in Python."""

import io
import json
import pathlib
import struct
import sys
import tempfile

import numpy as np
import rosbag
from PIL import Image as Pillow
from sensor_msgs.msg import CompressedImage, Image

import bags
import runs

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
import spikeloop  # noqa: E402

MS = 10**6
GREY = np.array([0.299, 0.587, 0.114])
WIDTH, HEIGHT = 7, 5  # odd: Bayer cells and chroma end within the image
GENERATOR = np.random.default_rng(8)
NODE = "  {name}: {{node: ros_sensor, topic: /{name}, message: {kind}, image: {{{keys}}}}}\n" \
       "  {name}_spikes: {{node: rate_encoder, rate_max: 100 Hz}}\n"


def scaled(values, least, most):
    return 2 * np.clip((values - least) / (most - least), 0, 1) - 1


def message(encoding, array, big_endian=False, gap=0, height=HEIGHT):
    """Rows of the array with `gap` bytes behind each."""
    bytes_ = array.astype(array.dtype.newbyteorder(">" if big_endian else "<")).tobytes()
    rows = np.frombuffer(bytes_, np.uint8).reshape(len(array), -1)
    rows = np.pad(rows, ((0, 0), (0, gap)), constant_values=91)
    return Image(height=height, width=WIDTH, encoding=encoding, step=rows.shape[1], is_bigendian=big_endian,
                 data=rows.tobytes())


def random_of(dtype, components=1, least=0, most=None):
    most = np.iinfo(dtype).max if most is None else most
    return GENERATOR.integers(least, most, (HEIGHT, WIDTH * components), endpoint=True).astype(dtype)


def coloured():
    """(name, message, keys, expected values) of interleaved colours."""
    for encoding, dtype, order in [
            ("rgb8", "u1", "rgb"), ("bgr8", "u1", "bgr"), ("rgba8", "u1", "rgba"), ("bgra8", "u1", "bgra"),
            ("rgb16", "u2", "rgb"), ("bgr16", "u2", "bgr"), ("rgba16", "u2", "rgba"), ("bgra16", "u2", "bgra"),
            ("8UC3", "u1", "bgr"), ("8UC4", "u1", "bgra"), ("16UC3", "u2", "bgr"), ("16UC4", "u2", "bgra")]:
        for big_endian in (False, True):
            array = random_of(dtype, len(order))
            pixels = array.reshape(HEIGHT, WIDTH, -1).astype(float)
            rgb = np.stack([pixels[:, :, order.index(c)] for c in "rgb"])
            white = np.iinfo(dtype).max
            name = f"c{encoding}{'_big' * big_endian}".lower()
            sent = message(encoding, array, big_endian, gap=3)
            yield name, sent, "channel: rgb", scaled(rgb, 0, white)
            yield name + "_grey", sent, "gain: 1", scaled(np.tensordot(GREY, rgb, 1), 0, white)


def measured():
    """Of numbers with a range."""
    for encoding, dtype in [("8SC1", "i1"), ("16UC1", "u2"), ("16SC1", "i2"), ("32SC1", "i4"), ("32FC1", "f4"),
                            ("64FC1", "f8")]:
        for big_endian in (False, True):
            least = 1 if dtype == "u2" else -90
            array = random_of(dtype, least=least, most=100)
            yield (f"n{encoding}{'_big' * big_endian}".lower(), message(encoding, array, big_endian, gap=8),
                   "range: [-50, 90]", scaled(array.astype(float), -50, 90))


def bayer():
    for pattern in ("rggb", "bggr", "gbrg", "grbg"):
        for bits in (8, 16):
            array = random_of(f"u{bits // 8}")
            rgb = np.empty((3, HEIGHT, WIDTH))
            for y, x in np.ndindex(HEIGHT, WIDTH):
                top, left = min(y // 2 * 2, HEIGHT // 2 * 2 - 2), min(x // 2 * 2, WIDTH // 2 * 2 - 2)
                cell = array[top:top + 2, left:left + 2].ravel().astype(float)
                rgb[:, y, x] = [np.mean([v for v, p in zip(cell, pattern) if p == c]) for c in "rgb"]
            yield (f"bayer_{pattern}{bits}", message(f"bayer_{pattern}{bits}", array, bits == 16, gap=2),
                   "channel: rgb", scaled(rgb, 0, 2**bits - 1))


def yuv():
    """BT.601 with samples from 0 to 255, and V4L2's planes."""
    def values(y, u, v):
        y, u, v = (np.asarray(plane, float) for plane in (y, u - 128.0, v - 128.0))
        rgb = np.stack([y + 1.402 * v, y - 0.344136 * u - 0.714136 * v, y + 1.772 * u])
        return scaled(np.clip(rgb, 0, 255), 0, 255), scaled(y, 0, 255)

    for encoding, shared in (("nv12", 2), ("nv21", 2), ("nv24", 1)):
        luma = random_of("u1")
        rows, columns = -(-HEIGHT // shared), -(-WIDTH // shared)
        chroma = GENERATOR.integers(0, 256, (rows, columns, 2), dtype=np.uint8)
        full = chroma.repeat(shared, 0).repeat(shared, 1)[:HEIGHT, :WIDTH]
        u, v = (full[:, :, 1], full[:, :, 0]) if encoding == "nv21" else (full[:, :, 0], full[:, :, 1])
        sent = Image(height=HEIGHT, width=WIDTH, encoding=encoding, step=WIDTH, data=luma.tobytes() + chroma.tobytes())
        rgb, grey = values(luma, u, v)
        yield encoding, sent, "channel: rgb", rgb
        yield encoding + "_grey", sent, "gain: 1", grey
    for encoding, order in (("yuv422", "uyvy"), ("uyvy", "uyvy"), ("yuv422_yuy2", "yuyv"), ("yuyv", "yuyv")):
        pairs = GENERATOR.integers(0, 256, (HEIGHT, 3, 4), dtype=np.uint8)
        first = order.index("y")
        u, v = (pairs[:, :, order.index(c)].repeat(2, 1) for c in "uv")
        sent = message(encoding, pairs.reshape(HEIGHT, -1), gap=4)
        sent.width = 6
        rgb, grey = values(pairs[:, :, first::2].reshape(HEIGHT, 6), u, v)
        yield encoding, sent, "channel: rgb", rgb
        yield encoding + "_grey", sent, "gain: 1", grey


def file_of(picture, kind, **options):
    data = io.BytesIO()
    picture.save(data, kind, **options)
    return data.getvalue()


def files():
    """What Pillow writes and reads again."""
    def rgb_of(data):
        pixels = np.array(Pillow.open(io.BytesIO(data)).convert("RGB"), float)
        return scaled(pixels.transpose(2, 0, 1), 0, 255)

    colours = Pillow.fromarray(random_of("u1", 3).reshape(HEIGHT, WIDTH, 3))
    alpha = Pillow.fromarray(random_of("u1", 4).reshape(HEIGHT, WIDTH, 4), "RGBA")
    grey = Pillow.fromarray(random_of("u1"))
    for name, data, sent in [
            ("jpeg", file_of(colours, "JPEG"), "bgr8; jpeg compressed bgr8"),
            ("jpeg_old", file_of(colours, "JPEG", progressive=True), "jpeg"),
            ("jpeg_grey", file_of(grey, "JPEG"), "mono8; jpeg compressed "),
            ("png", file_of(colours, "PNG"), "rgb8; png compressed"),
            ("png_grey", file_of(grey, "PNG"), "mono8; png compressed "),
            ("png_palette", file_of(colours.quantize(16), "PNG"), "png"),
            ("png_bits", file_of(grey.convert("1"), "PNG"), "png"),
            ("png_grey_alpha", file_of(grey.convert("LA"), "PNG"), "png")]:
        yield name, CompressedImage(format=sent, data=data), "channel: rgb", rgb_of(data)
    # Alpha is ignored.
    yield ("png_alpha", CompressedImage(format="rgba8; png compressed bgr8", data=file_of(alpha, "PNG")),
           "channel: rgb", scaled(np.array(alpha, float)[:, :, :3].transpose(2, 0, 1), 0, 255))


def depths():
    """16 bits of grey are distances, unless their format names another encoding."""
    depth = random_of("u2", least=1, most=5000)
    png = file_of(Pillow.fromarray(depth), "PNG")
    expected = scaled(depth.astype(float), 300, 4000)
    for name, sent, data in [("depth_png", "16UC1; png compressed ", png), ("depth_bare", "png", png),
                             ("depth", "16UC1; compressedDepth png", struct.pack("<iff", 0, 0, 0) + png),
                             ("depth_old", "16UC1; compressedDepth", struct.pack("<iff", 1, 0, 0) + png)]:
        yield name, CompressedImage(format=sent, data=data), "range: [300, 4000]", expected
    yield ("infrared", CompressedImage(format="mono16; png compressed ", data=png), "gain: 1",
           scaled(depth.astype(float), 0, 65535))
    metres = GENERATOR.uniform(0.4, 9, (HEIGHT, WIDTH)).astype(np.float32)
    a = np.float32(100 * 101)
    b = np.float32(1 - a / 10)
    png = file_of(Pillow.fromarray((a / metres + b).astype(np.uint16)), "PNG")
    yield ("metres", CompressedImage(format="32FC1; compressedDepth png", data=struct.pack("<iff", 1, a, b) + png),
           "range: [0, 10]", scaled(metres.astype(float), 0, 10))


def experiment(file, cases):
    """Writes one bag with the images of all cases, and an experiment with one sensor per case."""
    text = "experiment: encodings\nsync: unpaced\nrobot: {bag: images.bag}\nnodes:\n"
    with rosbag.Bag(str(file.parent / "images.bag"), "w") as bag:
        for name, sent, keys, _ in cases:
            text += NODE.format(name=name, kind=sent._type, keys=keys)
            bag.write(f"/{name}", sent, bags.genpy.Time(0, 5 * MS))
    text += "connections:\n"
    for name, _, _, values in cases:
        text += f"  - {name} -> {name}_spikes [{values.size}]\n"
    file.write_text(text)


def channels_of(pixels, keys):
    """Expected channels of a sensor with these keys."""
    least, most = json.loads(keys[7:]) if keys.startswith("range: ") else (0, np.iinfo(pixels.dtype).max)
    planes = pixels if pixels.ndim == 2 else np.moveaxis(pixels[..., :3], -1, 0)
    if planes.ndim == 3 and keys != "channel: rgb":
        planes = np.tensordot(GREY, planes, 1)
    elif planes.ndim == 2 and keys == "channel: rgb":
        planes = planes[None].repeat(3, 0)
    return scaled(planes.astype(float), least, most)


def check_values(scratch):
    cases = [case for make in (coloured, measured, bayer, yuv, files, depths) for case in make()]
    experiment(scratch / "all.yaml", cases)
    bags.spikeloop("run", scratch / "all.yaml", "--out", scratch / "run")
    for name, _, keys, expected in cases:
        _, values = runs.recordings.signal(scratch / "run", name)
        assert len(values) == 1, f"{name}: {len(values)} messages"
        # Colours of YUV, the green of Bayer cells and inverse depths are rounded to whole numbers.
        rounded = name.startswith(("bayer", "yuv", "uyvy", "yuyv", "nv")) and not name.endswith("_grey")
        tolerance = 0.02 if name == "metres" else 1.01 * 2 / 255 if rounded else 1e-5
        np.testing.assert_allclose(values[0], expected.ravel(), atol=tolerance, err_msg=name)
        if rounded or not name.startswith(("yuv", "uyvy", "yuyv", "nv")):  # the grey of YUV is its luma
            for recording in ("images.bag", "run/messages.mcap"):
                pixels, = spikeloop.read_messages(scratch / recording, f"/{name}").images()
                np.testing.assert_allclose(channels_of(pixels, keys), expected, atol=tolerance, err_msg=name)
    print(f"{len(cases)} encodings and formats as NumPy and Pillow read them")


def check_refusals(scratch):
    """An error that ends the run names encoding, topic and node."""
    picture = Pillow.fromarray(random_of("u1", 3).reshape(HEIGHT, WIDTH, 3))
    depth = file_of(Pillow.fromarray(random_of("u2")), "PNG")
    file = scratch / "wrong.yaml"
    for sent, code, words in [
            (message("8UC2", random_of("u1", 2)), "SL0511", "'8UC2'"),
            (message("32FC2", random_of("u1", 8)), "SL0511", "'32FC2'"),
            (message("16SC1", random_of("i2")), "SL0504", "16SC1 ... range: [300, 5000]"),
            (CompressedImage(format="16UC1; png compressed ", data=depth), "SL0504", "16UC1 ... range: [300, 5000]"),
            (CompressedImage(format="bgr8; webp", data=b"RIFF....WEBPVP8 "), "SL0511", "'bgr8; webp' ... WebP"),
            (CompressedImage(format="tiff", data=file_of(picture, "TIFF")), "SL0511", "'tiff' ... TIFF"),
            (CompressedImage(format="jpeg", data=file_of(picture, "BMP")), "SL0511", "'jpeg' ... BMP"),
            (CompressedImage(format="jpeg", data=file_of(picture.convert("CMYK"), "JPEG")), "SL0511", "CMYK"),
            (CompressedImage(format="h264", data=bytes(40)), "SL0511", "'h264'")]:
        experiment(file, [("eye", sent, "resize: [2, 2]", np.zeros(4))])
        runs.refused(f"wrong.yaml:5:3: node 'eye': topic '/eye': ... {words} ... [{code}]", "run", file, "--out",
                     scratch / "refused", "--force")


def main():
    with tempfile.TemporaryDirectory() as folder:
        check_values(pathlib.Path(folder))
        check_refusals(pathlib.Path(folder))


if __name__ == "__main__":
    main()
