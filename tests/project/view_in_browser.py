#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens pictures of scenes in headless Chromium and uses them, as a reader would.

    view_in_browser.py PROGRAM FOLDER [--screenshots FOLDER] [SCENE...]

Writes a picture of each scene into FOLDER by `PROGRAM show SCENE -o`, and of a motion by `PROGRAM simulate SCENE --view`, and opens them from the
disk, with that of what engines read of a file: light and dark, on a narrow screen, and without scripts. Exit status 1: an error was logged, nothing was drawn, keys,
wheel, fingers, sliders or boxes do nothing, a slider leaves the numbers, something was asked from the network, the page is wider
than the screen or the file larger than 700 kB. 77: there is no Chromium.
"""
import argparse
import base64
import subprocess
import sys
import tempfile
from pathlib import Path

from report_in_browser import LOOK, SKIP, Browser, complaints, find_chromium

LARGEST = 700_000  # bytes
SCENES = ["simple_pendulum", "puma_560", "humanoid_floating", "andrews_squeezer"]
TRAP = Path(__file__).resolve().parents[1] / "crosscheck/readers/trap.urdf"
MOTION = ["double_pendulum", "--duration", "1", "--outputs", "50"]

# What does nothing, as a list of sentences. Runs in the page, with scripts.
USE = r"""
(() => {
  const wrong = [];
  const picture = document.getElementById('picture');
  const page = window.dynwitness;
  if (!page) return ['the script did not run'];
  const drawn = () => { page.drawNow(); return picture.innerHTML; };
  const changes = (what, act) => { const before = drawn(); act(); if (drawn() === before) wrong.push(`${what} does nothing`); };
  const key = (name, shiftKey = false) => () =>
    picture.dispatchEvent(new KeyboardEvent('keydown', {key: name, shiftKey, bubbles: true, cancelable: true}));
  const first = drawn();
  if (picture.querySelectorAll('path, circle').length < 8) wrong.push('hardly anything is drawn');
  if (/NaN|undefined|Infinity/.test(first)) wrong.push('something is drawn nowhere');
  for (const name of ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-']) changes(`key ${name}`, key(name));
  changes('Shift and ArrowLeft', key('ArrowLeft', true));
  changes('wheel', () => picture.dispatchEvent(new WheelEvent('wheel', {deltaY: -200, bubbles: true, cancelable: true})));
  changes('key 0', key('0'));
  if (drawn() !== first) wrong.push('key 0 does not lead back');
  for (const button of document.querySelectorAll('#tools button'))
    if (button.textContent !== 'Reset view') changes(`button ${button.textContent}`, () => button.click());
  key('0')();
  for (const box of document.querySelectorAll('#parts input')) {
    if (box.parentElement.textContent.trim() === 'joint names' && page.scene.links.length > 60) continue;
    changes(`box ${box.parentElement.textContent.trim()}`, () => box.click());
    box.click();
  }
  // a joint about its link's axis of symmetry would show nothing but its frame
  for (const box of document.querySelectorAll('#parts input')) if (!box.checked) box.click();
  const sliders = [...document.querySelectorAll('#sliders input')];
  const own = page.scene.slots.filter(slot => !slot.follows).length;
  if (sliders.length !== own) wrong.push(`${sliders.length} sliders for ${own} positions`);
  sliders.slice(0, 12).forEach(slider => {
    // w of a quaternion whose others are 0 turns nothing, whatever it is
    if (!slider.parentElement.querySelector('label').textContent.endsWith('.w')) changes(`slider of ${slider.parentElement.querySelector('label').textContent}`, () => {
      slider.value = 0.37 * slider.max + 0.63 * slider.min;
      slider.dispatchEvent(new Event('input'));
    });
    if (!slider.getAttribute('aria-valuetext')) wrong.push('a slider says no value');
    if (!document.querySelector(`label[for=${slider.id}]`)) wrong.push('a slider has no label');
  });
  if (/NaN|undefined|Infinity/.test(drawn())) wrong.push('something moved is drawn nowhere');
  for (const button of document.querySelectorAll('#poses button')) button.click();
  const time = document.getElementById('time');
  if (time) {
    changes('time', () => { time.value = time.max; time.dispatchEvent(new Event('input')); });
    if (document.querySelectorAll('#energy path').length < 2) wrong.push('no energy is drawn');
    if (!document.getElementById('now').textContent.includes('s')) wrong.push('no time is told');
  }
  document.querySelector('#poses button').click();
  return wrong;
})()
"""

# Fingers, by the browser's own input: from here to there, from the middle of the picture.
TOUCH = [[(-20, 0)], [(20, 30)]], [[(-20, 0), (30, 0)], [(-50, 0), (60, 0)]]
MIDDLE = """
(() => {
  const picture = document.getElementById('picture');
  picture.scrollIntoView({block: 'center', behavior: 'instant'});
  const box = picture.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
})()
"""
DRAWN = "(window.dynwitness.drawNow(), document.getElementById('picture').innerHTML)"

# Without scripts: what was drawn beforehand.
STILL = r"""
(() => {
  const wrong = [];
  if (window.dynwitness) wrong.push('scripts run');
  const picture = document.getElementById('picture');
  if (picture.querySelectorAll('path, circle').length < 8) wrong.push('hardly anything is drawn without scripts');
  const box = picture.getBoundingClientRect();
  for (const part of picture.querySelectorAll('circle.com')) {
    const b = part.getBoundingClientRect();
    if (b.right < box.left || b.left > box.right || b.bottom < box.top || b.top > box.bottom)
      wrong.push('a centre of mass is drawn outside of the picture');
  }
  if (!picture.getAttribute('aria-label')) wrong.push('the picture has no label');
  if (getComputedStyle(document.querySelector('.controls')).display !== 'none') wrong.push('controls that do nothing are shown');
  return wrong;
})()
"""


def look(browser, page, view, light, width, scripts, screenshots):
    """What is wrong with a page in one view, as sentences."""
    target = browser.call("Target.createTarget", url="about:blank")["targetId"]
    session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
    browser.events.clear()
    for domain in ("Page", "Runtime", "Log", "Network"):
        browser.call(f"{domain}.enable", session)
    browser.call("Emulation.setDeviceMetricsOverride", session, width=width, height=900, deviceScaleFactor=1,
                 mobile=view == "narrow")
    browser.call("Emulation.setEmulatedMedia", session, features=[{"name": "prefers-color-scheme", "value": light}])
    browser.call("Emulation.setTouchEmulationEnabled", session, enabled=view == "narrow")
    browser.call("Emulation.setScriptExecutionDisabled", session, value=not scripts)
    browser.call("Page.navigate", session, url=page.as_uri())
    browser.wait_for("Page.loadEventFired")

    def ask(expression):
        answer = browser.call("Runtime.evaluate", session, expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            return [f"exception: {details.get('exception', {}).get('description', details['text'])}"]
        return answer["result"]["value"]

    found = ask(LOOK)
    wrong = found if isinstance(found, list) else found["wrong"]
    if screenshots:
        screenshots.mkdir(parents=True, exist_ok=True)
        shot = browser.call("Page.captureScreenshot", session, captureBeyondViewport=True)
        (screenshots / f"{page.stem}_{view}.png").write_bytes(base64.b64decode(shot["data"]))
    wrong += ask(USE if scripts else STILL)
    if view == "narrow":
        left, top = ask(MIDDLE)
        for begin, end in TOUCH:
            before = ask(DRAWN)
            for kind, points in (("touchStart", begin), ("touchMove", end), ("touchEnd", [])):
                browser.call("Input.dispatchTouchEvent", session, type=kind,
                             touchPoints=[{"x": left + x, "y": top + y, "id": k} for k, (x, y) in enumerate(points)])
            if ask(DRAWN) == before:
                wrong.append(f"{len(begin)} fingers do nothing")
    wrong += complaints(browser.events)
    browser.call("Target.closeTarget", targetId=target)
    return wrong


def main():
    parser = argparse.ArgumentParser(description="Opens pictures of scenes in headless Chromium and uses them.")
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("scene", nargs="*")
    parser.add_argument("--screenshots", type=Path, help="folder for a picture of each view")
    arguments = parser.parse_args()
    chromium = find_chromium()
    if not chromium:
        print("view_in_browser: skipped: no Chromium found (Debian: apt install chromium)")
        return SKIP

    folder = arguments.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    pages = []
    for scene in arguments.scene or SCENES:
        pages.append(folder / f"{Path(scene).stem}.html")
        subprocess.run([arguments.program, "show", scene, "-o", pages[-1]], check=True, stdout=subprocess.DEVNULL)
    if not arguments.scene:
        pages.append(folder / "motion.html")
        subprocess.run([arguments.program, "simulate", *MOTION, "--view", pages[-1]], check=True,
                       stdout=subprocess.DEVNULL)
        # the status is 1: engines have another robot
        subprocess.run([arguments.program, "readers", TRAP, "--html", folder / "readers.html"], stdout=subprocess.DEVNULL)
        pages.append(folder / "readers.view.html")
    wrong = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(chromium, profile)
        for page in pages:
            if page.stat().st_size > LARGEST:
                wrong.append(f"{page.stem}: {page.stat().st_size} bytes")
            for view, light, width, scripts in (("light", "light", 1280, True), ("dark", "dark", 1280, True),
                                                ("narrow", "light", 360, True), ("still", "light", 800, False)):
                wrong += [f"{page.stem}, {view}: {sentence}" for sentence in
                          look(browser, page, view, light, width, scripts, arguments.screenshots)]
        browser.close()
    for sentence in dict.fromkeys(wrong):
        print(f"view_in_browser: {sentence}")
    print(f"view_in_browser: {len(pages)} pictures: {'as they should be' if not wrong else 'NOT as they should be'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
