"""The page in Chromium, without a window."""

import contextlib
import json
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support import expected_conditions
from selenium.webdriver.support.ui import WebDriverWait


class Page:
    def __init__(self, driver, url):
        self.driver = driver
        driver.get(url)

    def hook(self):
        """What the page says of itself: live/page/hook.js."""
        return json.loads(self.driver.execute_script("return JSON.stringify(window.spikeloop || null)")) or {}

    def until(self, condition, seconds=60):
        """Until `condition` of the hook is true; the hook."""
        end = time.monotonic() + seconds
        while not condition(hook := self.hook()):
            assert time.monotonic() < end, f"not within {seconds} s: {hook}"
            time.sleep(0.05)
        return hook

    def element(self, name, by=By.ID):
        """As soon as it can be clicked: the page draws some things ten times a second."""
        return WebDriverWait(self.driver, 60).until(expected_conditions.element_to_be_clickable((by, name)))

    def click(self, name, by=By.ID):
        self.element(name, by).click()

    def press(self, key):
        """A key, on nothing in particular."""
        ActionChains(self.driver).send_keys(key).perform()

    def drag(self, name, right, down):
        """From the middle of an element, by pixels."""
        ActionChains(self.driver).drag_and_drop_by_offset(self.element(name), right, down).perform()

    def complaints(self):
        """Errors in the browser's console, but for what a run folder does not have yet."""
        return [entry["message"] for entry in self.driver.get_log("browser")
                if "/run/" not in entry["message"] and "favicon" not in entry["message"]]


@contextlib.contextmanager
def page(url):
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--window-size=1280,800", "--hide-scrollbars"):
        options.add_argument(argument)
    driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    try:
        yield Page(driver, url)
    finally:
        driver.quit()
