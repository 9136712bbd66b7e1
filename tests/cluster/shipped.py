#!/usr/bin/env python3
"""Checks the configuration files that docker/ ships for many nodes: each by the program that reads
it or by its schema, and all for consistency.

    tests/cluster/shipped.py

Parts whose programs are missing (haproxy, promtool, docker-compose, kubectl, python3-kubernetes,
npm's packages) are skipped with a message.
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
failed = 0


def expect(what, faults):
    global failed
    faults = list(faults)
    print(f"{'not ok' if faults else 'ok'} shipped: {what}" + (f": {faults}" if faults else ""), flush=True)
    failed += bool(faults)


def read_all(path):
    return [document for document in yaml.safe_load_all((DOCKER / path).read_text()) if document]


def by_program(what, program, *arguments, environment=None):
    if not shutil.which(program):
        return print(f"skip shipped: {what}: {program} is not installed")
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, env=dict(os.environ, **(environment or {})))
    expect(what, [done.stdout + done.stderr] if done.returncode else [])


# --- what reads them ----------------------------------------------------------------------------


def look_with_their_programs():
    with tempfile.TemporaryDirectory() as place:
        for name in ("prometheus.yaml", "alerts.yaml"):
            shutil.copy(DOCKER / name, place)
        (pathlib.Path(place) / "metrics-key").touch()
        text = (DOCKER / "haproxy.cfg").read_text().replace("maxconn 8000", "maxconn 400")
        (pathlib.Path(place) / "haproxy.cfg").write_text(text)
        by_program("HAProxy takes its configuration", "haproxy", "-c", "-f", f"{place}/haproxy.cfg")
        by_program("Prometheus takes its configuration and the alerts", "promtool", "check", "config", f"{place}/prometheus.yaml")
    for name in ("compose.yaml", "compose.single.yaml"):
        by_program(f"{name} has its schema", "docker-compose", "-f", DOCKER / name, "config", "-q",
                   environment={"POSTGRES_PASSWORD": "x", "GRAFANA_PASSWORD": "x"})


def look_at_dashboard():
    """Checks the dashboard by the types of Grafana's version in compose.yaml. Further members of
    annotations belong to the data source."""
    modules = PROGRAM.parent / "generators" / "node_modules"
    if not (modules / "@grafana/schema").is_dir():
        return print("skip shipped: Grafana's schema: npm's package @grafana/schema is not installed")
    dashboard = json.loads((DOCKER / "grafana-dashboard.json").read_text())
    for annotation in dashboard["annotations"]["list"]:
        for name in ("expr", "titleFormat"):
            annotation.pop(name, None)
    with tempfile.TemporaryDirectory() as place:
        (pathlib.Path(place) / "node_modules").symlink_to(modules)
        program = pathlib.Path(place) / "dashboard.ts"
        program.write_text('import type { Dashboard } from "@grafana/schema/dist/esm/raw/dashboard/x/dashboard_types.gen";\n'
                           f"export const dashboard: Dashboard = {json.dumps(dashboard, indent=1)};\n")
        by_program("the dashboard has Grafana's schema", "node", modules / "typescript/bin/tsc", "--strict", "--noEmit", "--module", "esnext",
                   "--moduleResolution", "bundler", "--skipLibCheck", program)
    sources = {panel["datasource"]["uid"] for panel in dashboard["panels"] if "datasource" in panel}
    expect("the dashboard takes the data source that is chosen, unedited", sources ^ {"${source}"})


def rendered(place, components):
    """Returns the manifests as kustomize writes them."""
    copy = pathlib.Path(place) / "docker"
    shutil.copytree(DOCKER, copy, ignore=lambda folder, names: OWN & set(names))
    if components:
        file = copy / "kustomization.yaml"
        file.write_text(file.read_text().replace("# components: [monitoring]", "components: [monitoring]"))
    done = subprocess.run(["kubectl", "kustomize", copy], capture_output=True, text=True)
    expect("kustomize builds the manifests" + (", and monitoring" if components else ""), [done.stderr] if done.returncode or done.stderr else [])
    return list(yaml.safe_load_all(done.stdout))


def look_at_monitoring():
    if not shutil.which("kubectl"):
        return print("skip shipped: kustomize: kubectl is not installed")
    with tempfile.TemporaryDirectory() as plain, tempfile.TemporaryDirectory() as monitored:
        base, whole = rendered(plain, False), rendered(monitored, True)
    monitors = {item["kind"]: item["spec"] for item in whole if item not in base}
    expect("monitoring adds the monitors", monitors.keys() ^ {"ServiceMonitor", "PodMonitor"})
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


class Models:
    """The Kubernetes API's schema, taken from the models of its Python client."""

    def __init__(self, client):
        self.client = client

    def faults(self, kind, value, where):
        """Yields the faults of a value that must have that type, in the client's spelling of
        types."""
        if found := re.fullmatch(r"list\[(.*)\]", kind):
            return [fault for i, item in enumerate(value) for fault in self.faults(found[1], item, f"{where}[{i}]")]
        if found := re.fullmatch(r"dict\(str, (.*)\)", kind):
            return [fault for key, item in value.items() for fault in self.faults(found[1], item, f"{where}.{key}")]
        plain = {"str": str, "int": int, "bool": bool, "float": (int, float), "object": object}.get(kind)
        if plain:
            return [] if isinstance(value, plain) else [f"{where} is no {kind}: {value!r}"]
        return self.faults_of_model(getattr(self.client, kind), value, where)

    def faults_of_model(self, model, value, where):
        if not isinstance(value, dict):
            return [f"{where} is not an object: {value!r}"]
        attribute = {json_name: name for name, json_name in model.attribute_map.items()}
        faults = [f"{where}.{name} is unknown" for name in value if name not in attribute]
        known = {attribute[name]: item for name, item in value.items() if name in attribute}
        try:
            model(**known)  # raises an error that says what is missing
        except ValueError as missing:
            faults.append(f"{where}: {missing}")
        return faults + [fault for name, item in known.items() for fault in self.faults(model.openapi_types[name], item, f"{where}.{model.attribute_map[name]}")]


def look_at_schema(manifests):
    try:
        from kubernetes import client
    except ImportError:
        return print("skip shipped: Kubernetes' schema: python3-kubernetes is not installed")
    models = Models(client)
    versions = {"apps/v1": "V1", "v1": "V1", "policy/v1": "V1"}
    expect("manifests have Kubernetes' schema", [fault for item in manifests for fault in
                                                 models.faults(versions[item["apiVersion"]] + item["kind"], item, f"{item['kind']} {item['metadata']['name']}")])


# --- what they say of each other ----------------------------------------------------------------


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
    look_at_dashboard()
    look_at_monitoring()
    look_at_single()
    text = (DOCKER / "haproxy.cfg").read_text()
    nodes = set(re.findall(r"^ *server (\S+) \1:8080 id", text, re.M))
    inter, fall = re.search(r"check inter (\S+) fall (\d+)", text).groups()
    noticed_ms = milliseconds(inter) * (int(fall) + 1)
    manifests = [item for path in sorted((DOCKER / "kubernetes").iterdir()) for item in read_all(f"kubernetes/{path.name}")]
    look_at_schema(manifests)
    look_at_compose(nodes, noticed_ms)
    look_at_kubernetes(manifests, nodes, noticed_ms)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
