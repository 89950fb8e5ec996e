"""What a user does on the page of `erlif start`."""

# Values of data_samples/straight_bushing as a user types them, with bare numbers and with units.
OF_THE_SAMPLE = {
    "camera1.band": "580",
    "camera2.band": "610 nm",
    "mechanism.crank": "5.5",
    "mechanism.coupler": "44",
    "mechanism.rocker": "26",
    "mechanism.ground": "0.51 m",
    "mechanism.crank_speed": "114",
    "joint.pin_radius": "33.36",
    "joint.bushing_radius": "33.59",
    "joint.length": "237",
    "joint.pin.youngs_modulus": "2.7",
    "joint.pin.poissons_ratio": "0.37",
    "joint.bushing.youngs_modulus": "2.7",
    "joint.bushing.poissons_ratio": "0.37",
    "oil.viscosity": "0.12",
    "oil.pressure_viscosity": "20",
}


def take(page, name):
    """Open the folder that is suggested."""
    page.click(f"#card-{name} .take")
    page.wait_for_selector(f"#card-{name} .anew:visible")
    page.wait_for_selector("#panel-1 canvas[data-text*='image 1 of']")


def type_in(page, name, values):
    for place, value in values.items():
        page.fill(f'[id="{name}.{place}"]', value)
        page.keyboard.press("Tab")
        page.wait_for_selector(f'#asked .field:not(.gap)[data-place="{place}"]')


def at(page, column, row):
    """Place on the page of the centre of a pixel of camera 1."""
    box = page.locator("#panel-1 canvas").bounding_box()
    left, right, top, bottom = 50, 82, 8, 38
    width, height = (
        int(page.evaluate(f"document.body.dataset.{one}")) for one in ("columns", "rows")
    )
    return (
        box["x"] + left + (column + 0.5) / width * (box["width"] - left - right),
        box["y"] + top + (row + 0.5) / height * (box["height"] - top - bottom),
    )


def drag(page, start, *way):
    page.locator("#panel-1 canvas").scroll_into_view_if_needed()
    page.mouse.move(*at(page, *start))
    page.mouse.down()
    for place in way:
        page.mouse.move(*at(page, *place), steps=4)
    page.mouse.up()
