"""A workflow of GitHub, gone through on this machine."""

import subprocess
from pathlib import Path

import yaml


def go_through(text: str, folder: Path, environment: dict[str, str], top: Path) -> list[str]:
    """Runs the commands of a workflow, whatever their conditions, and does what its actions would
    do; what is wrong."""
    workflow = yaml.safe_load(text)
    wrong = []
    # YAML 1.1 reads the key `on` as true.
    if not workflow.get("on", workflow.get(True)):
        wrong.append("the workflow never starts")
    for name, job in workflow["jobs"].items():
        for step in job["steps"]:
            fault = act(step, folder, top) if "uses" in step else command(step, folder, environment)
            if fault:
                wrong.append(f"job {name}: {fault}")
    return wrong


def act(step: dict, folder: Path, top: Path) -> str | None:
    action, given = step["uses"].split("@")[0], step.get("with", {})
    if action == "actions/checkout":
        if "path" in given:
            (folder / given["path"]).symlink_to(top)
    elif action == "actions/upload-artifact":
        if not list(folder.glob(given["path"])):
            return f"{given['path']} is not there to be kept"
    elif action != "actions/cache":
        return f"an action that is not tested: {action}"
    return None


def command(step: dict, folder: Path, environment: dict[str, str]) -> str | None:
    where = folder / step.get("working-directory", ".")
    if not where.is_dir():
        return f"no folder {where.name} for {step['run']}"
    done = subprocess.run(
        ["bash", "-eo", "pipefail", "-c", step["run"]],
        cwd=where,
        env=environment,
        text=True,
        capture_output=True,
        check=False,
    )
    return f"{step['run']}: {done.stdout}{done.stderr}" if done.returncode else None
