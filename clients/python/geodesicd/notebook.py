"""Draws a Mesh in notebooks, optionally with a Field and a Path: with pyvista or plotly, otherwise
as a picture that the daemon renders."""
from __future__ import annotations

import base64
import importlib
from typing import Any, Dict


class Picture(bytes):
    """A PNG file, which notebooks display."""

    def _repr_png_(self) -> bytes:
        return bytes(self)  # IPython rejects subclasses of bytes


def html(mesh: Any, caption: str, query: Dict[str, Any]) -> str:
    """Returns the daemon's picture with a caption as HTML."""
    picture = base64.b64encode(mesh.picture(size="480x360", **query)).decode()
    return f'<figure><img alt="{caption}" src="data:image/png;base64,{picture}"><figcaption>{caption}</figcaption></figure>'


def _module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _pyvista(pyvista: Any, mesh: Any, field: Any, path: Any) -> Any:
    numpy = importlib.import_module("numpy")
    vertices, faces = mesh.arrays()
    plotter = pyvista.Plotter()
    surface = pyvista.PolyData(vertices, numpy.insert(faces.astype(int), 0, 3, axis=1).ravel())
    plotter.add_mesh(surface, scalars=None if field is None else field.values(), cmap="viridis")
    if path is not None:
        plotter.add_lines(numpy.array(path.points), color="red", connected=True)
    return plotter.show()


def _plotly(graphs: Any, mesh: Any, field: Any, path: Any) -> Any:
    vertices, faces = (array.T for array in mesh.arrays())
    colours = {} if field is None else {"intensity": field.values(), "colorscale": "Viridis"}
    figure = graphs.Figure([graphs.Mesh3d(**dict(zip("xyz", vertices)), **dict(zip("ijk", faces)), **colours)])
    if path is not None:
        figure.add_trace(graphs.Scatter3d(**dict(zip("xyz", zip(*path.points))), mode="lines", line={"color": "red", "width": 6}))
    figure.update_layout(scene_aspectmode="data")
    return figure


def show(mesh: Any, field: Any = None, path: Any = None) -> Any:
    """Returns an interactive figure of pyvista or plotly, if one is installed; otherwise a Picture.
    A notebook displays a plotly figure or a Picture if it is the last value of a cell."""
    if _module("numpy") is not None:
        pyvista, graphs = _module("pyvista"), _module("plotly.graph_objects")
        if pyvista is not None:
            return _pyvista(pyvista, mesh, field, path)
        if graphs is not None:
            return _plotly(graphs, mesh, field, path)
    query: Dict[str, Any] = {} if field is None else {"field": field.id}
    if path is not None:
        query.update({"from": _compact(path.points[0]), "to": _compact(path.points[-1])})
    return Picture(mesh.picture(**query))


def _compact(xyz: Any) -> str:
    return "p:" + ",".join(repr(float(x)) for x in xyz)
