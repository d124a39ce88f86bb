"""What mkdocs runs on every page: the script for search from file:// comes from this site."""

from typing import Any

_SHIM = "https://unpkg.com/iframe-worker/shim"  # the offline plugin would load it from the network


def on_post_page(output: str, **_: Any) -> str:
    """The page with our own script in place of the one from the network."""
    return output.replace(_SHIM, "search_offline.js")


def on_post_template(output_content: str, **_: Any) -> str:
    """The same for 404.html."""
    return output_content.replace(_SHIM, "search_offline.js")
