# Answers like LAMMPS: tells its version, does every `run` by writing moments of a bed at 30 deg whose slope
# swings by SWING deg once in 0.4 s, and makes the files of `print`. From step DIES_AT on it breaks off.
#
# fake_lammps.py SWING DIES_AT [LOSES] < commands; with LOSES, a sphere is missing in the dump
import math, sys
print("LAMMPS (a fake)", flush=True)
swing, dies_at = float(sys.argv[1]), int(sys.argv[2])
loses = len(sys.argv) > 3
step, every, first, log = 0, 0, True, open("commands.txt", "w")
dt, radius, data = 1.0, 0.03, []
def moment():
    angle = math.radians(30 + swing * math.sin(2 * math.pi * step * dt / 0.4))
    n = len(open("drum.data").read().split("# hybrid")[1].split("\n")) - 3 - loses
    with open("bed.dump", "a") as out:
        out.write("ITEM: TIMESTEP\n%d\nITEM: NUMBER OF ATOMS\n%d\nITEM: BOX BOUNDS\n0 1\n0 1\n0 1\n" % (step, n))
        out.write("ITEM: ATOMS id type mol x y z radius vx vy vz\n")
        k = 0
        size = 0.05 * radius
        while k < n:
            for i in range(-20, 21):
                for j in range(-20, 21):
                    x, y = i * 2 * size * 0.9, j * 2 * size * 0.9
                    below = y * math.cos(angle) - x * math.sin(angle) < -0.1 * radius
                    if below and math.hypot(x, y) < radius - size and k < n:
                        out.write("%d 1 %d %.9g %.9g 0 %g %g %g 0\n" % (k, k, x, y, size, -1.047 * y, 1.047 * x))
                        k += 1
for line in sys.stdin:
    log.write(line); log.flush()
    words = line.split()
    if not words: continue
    if words[0] == "timestep": dt = float(words[1])
    if words[0] == "dump": every = int(words[4])
    if words[0] == "run":
        if step >= dies_at: print("ERROR: Lost atoms", flush=True); sys.exit(1)
        end = step + int(words[1])
        while every and step < end:
            if first: moment(); first = False
            step += every; moment()
        step = end
    if words[0] == "print": open(words[3], "w").write("done\n")
