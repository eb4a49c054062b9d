"""Puts KaTeX, which draws the equations, into the built site. It comes from Debian's package libjs-katex."""

import logging
import shutil
from pathlib import Path

KATEX = Path("/usr/share/javascript/katex")
FONTS = Path("/usr/share/fonts/truetype/katex")


def on_post_build(config, **_):
    target = Path(config["site_dir"]) / "assets" / "katex"
    if not KATEX.is_dir():
        logging.getLogger("mkdocs.hooks").info("equations stay TeX: the package libjs-katex is not installed")
        return
    (target / "contrib").mkdir(parents=True, exist_ok=True)
    for name in ("katex.min.js", "katex.min.css", "contrib/auto-render.js"):
        shutil.copyfile(KATEX / name, target / name)
    fonts = FONTS if FONTS.is_dir() else KATEX / "fonts"
    shutil.copytree(fonts, target / "fonts", dirs_exist_ok=True,
                    ignore=lambda _, names: [name for name in names if not name.endswith(".woff2")])
