"""What the system says that a process holds; the usual call tells its parent's peak as its own."""

from pathlib import Path


def status_bytes(key: str) -> int:
    """``VmRSS``, now held, or ``VmHWM``, the most ever held by this process. [bytes]

    Raises
    ------
    OSError
        If this system does not tell.
    """
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{key}:"):
            return int(line.split()[1]) * 1024
    raise OSError(f"no {key} in /proc/self/status")
