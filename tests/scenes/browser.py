"""Chromium for tests of pages: how it starts, and what must not happen on a page."""

import shutil
from contextlib import contextmanager

import pytest

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
MARKS = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="this machine has no Chromium"),
]
_FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)


@contextmanager
def chromium():
    """A browser; the test is skipped without playwright."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=list(_FLAGS))
        yield browser
        browser.close()


@contextmanager
def pages(browser, *, own):
    """A function that makes pages; errors and requests beyond the addresses `own` fail."""
    faults, contexts = [], []

    def start(**options):
        contexts.append(browser.new_context(**options))
        page = contexts[-1].new_page()
        page.set_default_timeout(20_000)
        page.on("pageerror", lambda error: faults.append(f"error: {error}"))
        page.on("requestfailed", lambda request: faults.append(f"failed: {request.url}"))
        page.on("dialog", lambda dialog: faults.append(f"dialog: {dialog.message}"))

        def check(request):
            if not request.url.removeprefix("blob:").startswith(own):
                faults.append(f"elsewhere: {request.url}")

        page.on("request", check)
        return page

    yield start
    for context in contexts:
        context.close()
    assert not faults, "; ".join(faults)
