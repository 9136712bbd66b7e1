// The page's behaviour: a thin client of the same HTTP API that everybody uses.

const element = (id) => document.getElementById(id);

function say(id, text, wrong = false) {
  element(id).textContent = text;
  element(id).classList.toggle("wrong", wrong);
}

// The sentence of a problem (RFC 9457), with its reason where there is one.
function sentence(problem, status) {
  if (!problem || !problem.detail) return `The server answered ${status}.`;
  return problem.reason ? `${problem.detail} (${problem.reason})` : problem.detail;
}

async function call(url, options) {
  const response = await fetch(url, options);
  if (response.status === 204) return null;
  const body = await response.json().catch(() => null);
  if (!response.ok) throw new Error(sentence(body, response.status));
  return body;
}

// --- meshes ----------------------------------------------------------------------------------------------------------

const meshUrl = (name) => `/v1/meshes/${encodeURIComponent(name)}`;

function bytes(count) {
  const units = ["B", "KiB", "MiB", "GiB", "TiB"];
  let unit = 0;
  for (; count >= 1024 && unit < units.length - 1; unit++) count /= 1024;
  return `${unit ? count.toPrecision(3) : count} ${units[unit]}`;
}

function cell(content) {
  const td = document.createElement("td");
  td.append(content);
  return td;
}

function deleteButton(mesh) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "delete";
  button.addEventListener("click", async () => {
    try {
      await call(meshUrl(mesh.name), { method: "DELETE" });
      await refresh();
    } catch (error) {
      say("meshes-message", error.message, true);
    }
  });
  return button;
}

function row(mesh) {
  const tr = document.createElement("tr");
  const counts = [mesh.vertices, mesh.faces, mesh.components, mesh.boundaries.length, mesh.genus];
  const measures = [mesh.area.toPrecision(6), bytes(mesh.memory_bytes)];
  const texts = [mesh.name, ...counts.map((n) => n.toLocaleString()), ...measures];
  tr.append(...texts.map(cell), cell(deleteButton(mesh)));
  return tr;
}

function option(mesh) {
  const item = document.createElement("option");
  item.value = item.textContent = mesh.name;
  return item;
}

async function appendPage(after) {
  const page = await call(`/v1/meshes?limit=100${after ? `&after=${encodeURIComponent(after)}` : ""}`);
  element("meshes").append(...page.meshes.map(row));
  element("mesh").append(...page.meshes.map(option));
  element("more").hidden = !page.next;
  element("more").onclick = () => appendPage(page.next);
}

async function refresh(selected = element("mesh").value) {
  element("meshes").replaceChildren();
  element("mesh").replaceChildren();
  say("meshes-message", "");
  try {
    await appendPage();
    element("mesh").value = selected;
    if (element("mesh").selectedIndex < 0) element("mesh").selectedIndex = 0;
    if (!element("meshes").children.length) say("meshes-message", "No meshes yet.");
  } catch (error) {
    say("meshes-message", error.message, true);
  }
}

// --- upload ----------------------------------------------------------------------------------------------------------

// A name that the API takes: the file's, without its ending and other characters.
function meshName(file) {
  const stem = file.name.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9._-]/g, "-");
  return (/^[A-Za-z0-9_-]/.test(stem) ? stem : `mesh${stem}`).slice(0, 128);
}

// XMLHttpRequest, because fetch does not tell how far an upload has come.
function send(file, onProgress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", meshUrl(meshName(file)));
    request.responseType = "json";
    request.upload.onprogress = (event) => onProgress(event.loaded / event.total);
    request.onload = () =>
      request.status < 300 ? resolve(request.response) : reject(new Error(sentence(request.response, request.status)));
    request.onerror = () => reject(new Error("The connection broke."));
    request.send(file);
  });
}

async function upload(file) {
  const progress = element("progress");
  progress.hidden = false;
  say("upload-message", `Sending ${file.name} (${bytes(file.size)}).`);
  try {
    const mesh = await send(file, (part) => {
      progress.value = part;
      if (part === 1) say("upload-message", "Building the mesh.");
    });
    say("upload-message", `${mesh.name}: ${mesh.faces.toLocaleString()} faces.`);
    await refresh(mesh.name);
  } catch (error) {
    say("upload-message", error.message, true);
  }
  progress.hidden = true;
}

function watchDrop(area) {
  const highlight = (event, over) => {
    event.preventDefault();
    area.classList.toggle("over", over);
  };
  area.addEventListener("dragover", (event) => highlight(event, true));
  area.addEventListener("dragleave", (event) => highlight(event, false));
  area.addEventListener("drop", (event) => {
    highlight(event, false);
    if (event.dataTransfer.files.length) upload(event.dataTransfer.files[0]);
  });
}

// --- ask -------------------------------------------------------------------------------------------------------------

function pointText(point) {
  const at = point.xyz.map((x) => x.toPrecision(6)).join(", ");
  if ("vertex" in point) return `vertex ${point.vertex} at ${at}`;
  if ("edge" in point) return `edge ${point.edge.join("-")}, t = ${point.t} at ${at}`;
  return `face ${point.face} (${point.barycentric.join(", ")}) at ${at}`;
}

function distanceText(answer) {
  if (answer.distance !== null) return String(answer.distance);
  return answer.reason === "no_path" ? "none: the points are in different components" : `none: ${answer.reason}`;
}

const pathText = (path) => (path ? `${path.points.length} points, length ${path.length}` : "none");

function show(answer, milliseconds) {
  element("distance").textContent = distanceText(answer);
  element("answer-from").textContent = pointText(answer.from);
  element("answer-to").textContent = pointText(answer.to);
  element("path").textContent = pathText(answer.path);
  element("time").textContent = `${milliseconds.toFixed(1)} ms, there and back`;
  element("answer").hidden = false;
}

async function ask(event) {
  event.preventDefault();
  const query = new URLSearchParams({ from: element("from").value.trim(), to: element("to").value.trim() });
  const url = `${meshUrl(element("mesh").value)}/${event.submitter.value}?${query}`;
  element("curl").textContent = `curl '${location.origin}${url}'`;
  element("curl-row").hidden = false;
  element("answer").hidden = true;
  say("ask-message", "");
  try {
    const started = performance.now();
    const answer = await call(url);
    show(answer, performance.now() - started);
  } catch (error) {
    say("ask-message", error.message, true);
  }
}

// --- start -----------------------------------------------------------------------------------------------------------

element("file").addEventListener("change", (event) => {
  if (event.target.files.length) upload(event.target.files[0]);
  event.target.value = "";
});
element("ask").addEventListener("submit", ask);
element("copy").addEventListener("click", () => navigator.clipboard.writeText(element("curl").textContent));
watchDrop(element("drop"));
call("/v1").then((service) => (element("version").textContent = `Version ${service.version}.`)).catch(() => {});
refresh();
