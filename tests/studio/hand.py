"""A page of the studio in a browser, and what a hand does to it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any


class Page:
    """A page of the studio and what a hand does to it."""

    def __init__(self, driver: Any, address: str) -> None:
        self.driver = driver
        driver.get(address)
        self.until(lambda: self.all("[data-kind]"), "the page opens")

    def all(self, selector: str) -> list[Any]:
        return list(self.driver.find_elements("css selector", selector))

    def one(self, selector: str) -> Any:
        return self.driver.find_element("css selector", selector)

    def until(self, what: Callable[[], Any], told: str) -> Any:
        end = time.monotonic() + 20
        while time.monotonic() < end:
            try:
                found = what()
            except Exception:
                found = None
            if found:
                return found
            time.sleep(0.03)
        raise AssertionError(f"not so after 20 s: {told}")

    def click(self, selector: str) -> None:
        self.until(lambda: self.one(selector), selector)
        self.one(selector).click()

    def write(self, selector: str, text: str) -> None:
        from selenium.webdriver.common.keys import Keys

        field = self.until(lambda: self.one(selector), selector)
        field.click()
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(text, Keys.ENTER)

    def keys(self, *keys: str) -> None:
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.driver).send_keys(*keys).perform()

    def chord(self, holder: str, key: str) -> None:
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.driver).key_down(holder).send_keys(key).key_up(holder).perform()

    def drag(self, source: Any, target: Any) -> None:
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.driver, duration=30).click_and_hold(source).move_to_element(
            target
        ).release().perform()

    def node(self, name: str) -> Any:
        return self.one(f'[data-node="{name}"] .letters')

    def strokes(self, text: str) -> list[str]:
        """Return the strokes of a bond: its ends, with what they are besides solid."""
        return [
            f"{s.get_attribute('data-end')}{s.get_attribute('class').removeprefix('stroke')}"
            for s in self.all(f'[data-text="{text}"] .stroke')
        ]

    def complaints(self) -> list[str]:
        """Return what the page itself did wrong; that an old server is gone is no fault of it."""
        severe = [e for e in self.driver.get_log("browser") if e["level"] == "SEVERE"]
        return [str(e["message"]) for e in severe if "WebSocket" not in e["message"]]
