"""Prints the spheres of seed.yade as YADE reads them, alone and as one clump."""

import json

from yade import O, ymport


def row(body):
    """Centre and radius of a sphere."""
    return [*body.state.pos, body.shape.radius]


text = [row(body) for body in ymport.text("seed.yade")]
ymport.textClumps("seed.yade")
clump = [row(body) for body in O.bodies if not body.isClump]
print("\n" + json.dumps({"text": text, "clump": clump}), flush=True)
