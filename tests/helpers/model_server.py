"""A local server of models, and two small models for it."""

import hashlib
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np

from symjax.datasets import Original

# a prism of quads and triangles with textures, normals, groups and materials, as in the published files
PRISM = b"""# a tent, mirror x = 0.5
mtllib tent.mtl
o tent
v 0.500000 1.000000 0.000000
v -1.000000 0.000000 0.000000
v 2.000000 0.000000 0.000000
v 0.500000 1.000000 4.000000
v -1.000000 0.000000 4.000000
v 2.000000 0.000000 4.000000
vt 0.0 0.0
vt 1.0 0.5
vn 0.0 0.0 1.0
g ends
usemtl cloth
s off
f 3/1/1 2/2/1 1/1/1
f 4/1/1 5/2/1 6/1/1
g sides
f 1/1/1 2/2/1 5/1/1 4/2/1
f 3/1/1 1/2/1 4/1/1 6/2/1
f 2/1/1 3/2/1 6/1/1 5/2/1
"""
CORNERS = np.array([[0.5, 1, 0], [-1, 0, 0], [2, 0, 0], [0.5, 1, 4], [-1, 0, 4], [2, 0, 4]])
SCAN = b"""# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS x y z intensity
SIZE 4 4 4 4
TYPE F F F F
COUNT 1 1 1 1
WIDTH 6
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS 6
DATA binary
""" + np.column_stack([CORNERS, np.ones(6)]).astype("<f4").tobytes()


class Site:
    """A local HTTP server.

    Attributes:
        pages: status, body and announced length of every page, by path.
        asked: paths of the requests so far.
        gate: event that requests wait for after their response; clear it to leave connections open.
    """

    def __init__(self):
        self.pages, self.asked, self.gate = {}, [], threading.Event()
        self.gate.set()
        site = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                site.asked.append(self.path)
                status, body, length = site.pages.get(self.path, (404, b"", 0))
                self.send_response(status)
                self.send_header("Content-Length", str(length))
                self.end_headers()
                self.wfile.write(body)
                site.gate.wait()

            def log_message(self, *_):
                """Suppresses the log."""

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.01})
        self.thread.start()

    def put(self, path, body, *, status=200, length=None):
        self.pages[path] = (status, body, len(body) if length is None else length)
        return f"http://127.0.0.1:{self.server.server_port}{path}"

    def close(self):
        self.gate.set()
        if self.thread.is_alive():
            self.server.shutdown()
            self.thread.join()
            self.server.server_close()


def original(url, body, normal=(1.0, 0.0, 0.0), offset=0.5, symmetry="exact"):
    digest = hashlib.sha256(body).hexdigest()
    return Original(url, digest, len(body), "CC BY 4.0", "a tentmaker", normal, offset, symmetry)
