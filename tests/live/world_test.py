"""The world in three dimensions: what the page draws is what rays from its pixels meet."""

import base64
import io
import json
import pathlib
import re
import unittest

import browser
import matplotlib.image
import numpy as np
import viewing

WORLDS = pathlib.Path(__file__).parents[2] / "robots/vehicle/worlds"
EXPERIMENT = """
experiment: heights
duration: 10 h
sync: lockstep
robot: {{simulator: mujoco, world: {world}}}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  eye: {{node: poisson_encoder, rate_min: 1 Hz, rate_max: 1 Hz}}
connections:
  - scan[0:20] -> eye
"""
# Half the heights of the obstacles in place of 0.25 m, in the order of arena.xml.
HALF_HEIGHTS = (0.45, 0.1, 0.25, 0.4, 0.15, 0.3)
TOPS = {"light": (0xd9, 0xd9, 0xd9), "dark": (0x4a, 0x4f, 0x57)}  # live/page/palette.js, fill
EDGE = 2.0  # pixels at the edges of tops are not compared: lines


def write_world(folder):
    """arena.xml with obstacles of other heights, and a long one, which does not move."""
    heights = iter(HALF_HEIGHTS)

    def other_height(match):
        height = next(heights)
        return f'{match[1]} {height}">{match[2]}{match[3]} {height}" material'

    text, count = re.subn(r'(mocap="true" pos="\S+ \S+) 0.25">(\s+)(<geom type="\w+" size="[^"]+) 0.25" material',
                          other_height, (WORLDS / "arena.xml").read_text())
    assert count == len(HALF_HEIGHTS)
    long = '<body name="obstacle_long" pos="-2 0.5 0.35" euler="0 0 30"><geom type="box" size="0.1 0.8 0.35"/></body>'
    path = folder / "heights.xml"
    path.write_text(text.replace("</worldbody>", f"{long}</worldbody>"))
    return path


class Rays:
    """Lines of sight through pixels. The camera: the world is turned by -azimuth about the vertical axis and then
    tilted, and is seen along the third axis."""

    def __init__(self, world):
        view = world["view"]
        turn, tilt = -view["azimuth"], view["elevation"] - np.pi / 2
        about_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        about_x = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
        camera = about_x @ about_z
        column, row = np.meshgrid(np.arange(world["width"]) + 0.5, np.arange(world["height"]) + 0.5)
        across = (column - world["width"] / 2) / view["scale"], (world["height"] / 2 - row) / view["scale"]
        # A point of each ray, and the direction to the viewer; camera.T is the inverse.
        self.begin = np.stack([*across, np.zeros_like(across[0])], axis=-1) @ camera + [view["x"], view["y"], 0]
        self.viewer = camera.T @ [0, 0, 1]
        self.pixel = 1 / (view["scale"] * np.sin(view["elevation"]))  # metres of a horizontal plane, at most

    def at(self, height, chosen=...):
        """x and y where the rays, or the chosen ones, have this height."""
        begin = self.begin[chosen]
        point = begin + self.viewer * ((height - begin[..., 2:]) / self.viewer[2])
        return point[..., 0], point[..., 1]


def depth(solid, x, y):
    """How deep points lie in a footprint, in metres; below 0: outside."""
    dx, dy = x - solid["x_m"], y - solid["y_m"]
    if solid["shape"] == "cylinder":
        return solid["radius_m"] - np.hypot(dx, dy)
    cos, sin = np.cos(solid["theta_rad"]), np.sin(solid["theta_rad"])
    return np.minimum(solid["half_x_m"] - abs(cos * dx + sin * dy), solid["half_y_m"] - abs(cos * dy - sin * dx))


def above(rays, chosen, height, others):
    """How deep the chosen rays come into others above a height, in metres; below 0: they pass by."""
    deepest = np.full(chosen.sum(), -np.inf)
    for other in others:
        if other["height_m"] > height:
            for each in np.linspace(height, other["height_m"], 40):
                deepest = np.maximum(deepest, depth(other, *rays.at(each, chosen)))
    return deepest


def walls(arena):
    """Boxes outside the arena, as wide as they may be drawn."""
    x, y = (arena["min_x_m"] + arena["max_x_m"]) / 2, (arena["min_y_m"] + arena["max_y_m"]) / 2
    size, thick = arena["max_x_m"] - x + 0.2, 0.1
    return [{"shape": "box", "x_m": x + i * (size - thick), "y_m": y + k * (size - thick), "theta_rad": 0,
             "half_x_m": thick if i else size, "half_y_m": thick if k else size, "height_m": arena["wall_height_m"]}
            for i, k in ((1, 0), (-1, 0), (0, 1), (0, -1))]


class World(viewing.FolderCase):
    def picture(self, page):
        """The pixels of the canvas, as soon as they no longer change."""
        before, shown = None, None
        while before is None or before != shown:
            before = shown
            page.driver.execute_async_script("requestAnimationFrame(() => setTimeout(arguments[0], 200))")
            shown = page.driver.execute_script("return document.getElementById('world-canvas').toDataURL()")
        pixels = matplotlib.image.imread(io.BytesIO(base64.b64decode(shown.split(",")[1])))
        return np.round(255 * pixels).astype(int)

    def compare(self, page, world, colour):
        """The tops of obstacles are where rays meet them, and nowhere else."""
        pixels = self.picture(page)
        drawn = page.hook()
        rays = Rays(drawn["world"])
        self.assertEqual(pixels.shape[:2], rays.begin.shape[:2])
        is_top = (pixels[..., :3] == colour).all(axis=-1) & (pixels[..., 3] == 255)
        robot = {"shape": "cylinder", "x_m": drawn["pose"]["x"], "y_m": drawn["pose"]["y"],
                 "radius_m": world["vehicle_radius_m"], "height_m": world["vehicle_height_m"]}
        edge, elsewhere = EDGE * rays.pixel, is_top.copy()
        for solid in world["obstacles"]:
            height = solid["height_m"]
            inside = depth(solid, *rays.at(height))
            chosen = inside > -edge
            hidden = above(rays, chosen, height, [each for each in (*world["obstacles"], robot) if each is not solid])
            behind_walls = above(rays, chosen, height, walls(world["arena"]))
            sure = (inside[chosen] > edge) & (hidden < -edge) & (behind_walls < -edge)
            self.assertGreater(sure.sum(), 40, solid)
            self.assertGreater(is_top[chosen][sure].mean(), 0.995, solid)
            elsewhere[chosen] &= hidden > edge
        self.assertLess(elsewhere.sum(), 0.001 * is_top.sum())

    def test_tops_of_obstacles_are_where_rays_meet_them(self):
        experiment = self.folder / "heights.yaml"
        experiment.write_text(EXPERIMENT.format(world=write_world(self.folder)))
        with viewing.Run(self.folder / "run", experiment=experiment) as job, browser.page(job.url) as page:
            page.until(lambda hook: hook.get("pose") and hook["trajectoryRows"])
            page.click("pause")
            page.until(lambda hook: hook["paused"])
            page.click(".enlarge[data-panel=world]", "css selector")
            world = json.loads((self.folder / "run/world.json").read_text())
            heights = sorted(each["height_m"] for each in world["obstacles"])
            np.testing.assert_allclose(heights, sorted(2 * np.array([*HALF_HEIGHTS, 0.35])))
            self.assertFalse(page.hook()["world"]["oblique"])
            page.press("3")
            page.until(lambda hook: hook["world"]["oblique"])
            before = page.hook()["world"]["view"]
            theme = page.driver.execute_script("return document.documentElement.dataset.theme")
            self.compare(page, world, TOPS[theme])
            for right, down in ((120, 30), (-330, -40), (250, 0)):  # other sides hide and are hidden
                page.drag("world-canvas", right, down)
                self.compare(page, world, TOPS[theme])
            view = page.hook()["world"]["view"]
            self.assertNotAlmostEqual(view["azimuth"], before["azimuth"], 2)
            self.assertNotAlmostEqual(view["elevation"], before["elevation"], 2)
            page.click("theme")
            self.compare(page, world, TOPS[{"light": "dark", "dark": "light"}[theme]])
            page.driver.refresh()
            page.until(lambda hook: hook.get("world", {}).get("oblique"))  # it is kept
            page.click("world-3d")
            view = page.until(lambda hook: not hook["world"]["oblique"])["world"]["view"]
            self.assertEqual((view["azimuth"], view["elevation"]), (0, np.pi / 2))
            self.assertEqual(page.complaints(), [])
            job.interrupt()


if __name__ == "__main__":
    unittest.main()
