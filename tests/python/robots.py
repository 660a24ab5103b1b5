"""Where the robots of example-robot-data lie."""

from importlib.metadata import distribution
from pathlib import Path


def example_robots() -> Path:
    """The folder with one `<robot>_description` each; `package://example-robot-data/robots/…` means this."""
    package = distribution("example-robot-data")
    file = next(file for file in package.files if file.name == "package.xml" and "share" in file.parts)
    return Path(package.locate_file(file)).resolve().parent / "robots"
