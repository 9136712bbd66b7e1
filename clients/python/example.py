#!/usr/bin/env python3
"""Uploads a mesh and computes a shortest path: example.py MESH.obj"""
import sys

import geodesicd

client = geodesicd.Client()
mesh = client.upload("example", sys.argv[1])
path = mesh.path(0, (0.5, 0.5, 0.5))
print(f"{path.length:.12g} over {len(path.points)} points")
