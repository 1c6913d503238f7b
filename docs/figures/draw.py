#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the pictures that explain: task, frames, camera_frames, nominal_and_real, gate, joint_error,
selection.

usage: draw.py           writes docs/figures/*.svg
       draw.py --check   exits with 1 if a picture is another one

Lines differ in grey as well: what is meant is dashed and light, what is real is solid and dark. Letters are 20 units high
in pictures 720 wide, so they can be read at half width.
"""
import math
import pathlib
import sys

INK, REAL, MEANT, SENSOR, PALE = "#1f2937", "#174a7c", "#8a94a3", "#b45309", "#eef1f5"
FONT = 20


def num(x):
    text = f"{x:.1f}"
    return text[:-2] if text.endswith(".0") else text


class Picture:
    def __init__(self, title, width, height):
        self.width, self.height = width, height
        self.parts = [f"<title>{title}</title>", f'<rect width="{width}" height="{height}" fill="#ffffff"/>']

    def line(self, points, color=INK, width=2.0, dash="", close=False, fill="none", arrow=False):
        path = "M" + "L".join(f"{num(x)} {num(y)}" for x, y in points) + ("Z" if close else "")
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<path d="{path}" fill="{fill}" stroke="{color}" stroke-width="{num(width)}" stroke-linejoin="round" '
                          f'stroke-linecap="round"{dashes}/>')
        if arrow:
            (x0, y0), (x1, y1) = points[-2:]
            a = math.atan2(y1 - y0, x1 - x0)
            size = 5 + 2.5 * width
            wings = [(x1 - size * math.cos(a + s * 0.42), y1 - size * math.sin(a + s * 0.42)) for s in (1, -1)]
            self.line([wings[0], (x1, y1), wings[1]], color, width, close=True, fill=color)

    def circle(self, x, y, r, color=INK, fill="#ffffff", width=2.0, dash=""):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<circle cx="{num(x)}" cy="{num(y)}" r="{num(r)}" fill="{fill}" stroke="{color}" '
                          f'stroke-width="{num(width)}"{dashes}/>')

    def box(self, x, y, w, h, color=INK, fill=PALE):
        self.parts.append(f'<rect x="{num(x)}" y="{num(y)}" width="{num(w)}" height="{num(h)}" rx="8" fill="{fill}" '
                          f'stroke="{color}" stroke-width="2"/>')

    def text(self, x, y, words, anchor="start", color=INK, bold=False):
        weight = ' font-weight="bold"' if bold else ""
        for k, line in enumerate(words.split("\n")):
            self.parts.append(f'<text x="{num(x)}" y="{num(y + 1.25 * FONT * k)}" text-anchor="{anchor}" fill="{color}"{weight}>'
                              f"{line}</text>")

    def ground(self, x0, x1, y):
        self.line([(x0, y), (x1, y)], INK, 2)
        for x in range(int(x0) + 12, int(x1), 22):
            self.line([(x, y), (x - 10, y + 10)], MEANT, 1.5)

    def arm(self, foot, lengths, angles, color, dash="", width=10.0):
        """A planar arm on its pedestal; angles add up, degrees from the vertical. Returns the points of its joints."""
        x, y = foot
        self.line([(x - 26, y), (x + 26, y), (x + 16, y - 34), (x - 16, y - 34)], color, 2, close=True,
                  fill="#ffffff" if dash else PALE, dash="6 5" if dash else "")
        points, total = [(x, y - 40)], 0.0
        for length, angle in zip(lengths, angles):
            total += math.radians(angle)
            x0, y0 = points[-1]
            points.append((x0 + length * math.sin(total), y0 - length * math.cos(total)))
        self.line(points, color, 3 if dash else width, dash="9 7" if dash else "")
        for px, py in points[:-1]:
            self.circle(px, py, 8 if dash else 9, color, "#ffffff", 2.5)
        return points

    def frame(self, x, y, angle=0.0, size=44, color=INK):
        """Two axes of a frame; the third one points at the reader."""
        for k, turn in ((0, angle), (1, angle - 90)):
            a = math.radians(turn)
            self.line([(x, y), (x + size * math.cos(a), y + size * math.sin(a))], color, 3, arrow=True)
        self.circle(x, y, 4.5, color, color)

    def tracker(self, x, y):
        self.line([(x, y - 60), (x - 24, y)], SENSOR, 4)
        self.line([(x, y - 60), (x + 24, y)], SENSOR, 4)
        self.line([(x, y - 60), (x, y)], SENSOR, 4)
        self.box(x - 20, y - 100, 40, 40, SENSOR, "#ffffff")
        self.circle(x, y - 80, 10, SENSOR, SENSOR)

    def svg(self):
        body = "\n".join(self.parts)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" width="{self.width}" '
                f'height="{self.height}" font-family="Helvetica, Arial, sans-serif" font-size="{FONT}" role="img">\n{body}\n</svg>\n')


def reflector(p, x, y, color=REAL, dash=""):
    p.circle(x, y, 9, color, "#ffffff" if dash else color, 2.5, dash)


def task():
    p = Picture("A tracker measures the real arm; a corrected command takes its tool to the target", 720, 400)
    p.ground(20, 700, 360)
    p.tracker(90, 360)
    meant = p.arm((360, 360), [120, 120, 46], [12, 68, 62], MEANT, dash="9 7")
    real = p.arm((360, 360), [126, 114, 46], [4, 84, 70], REAL)
    p.line([(104, 278), (real[-1][0] - 14, real[-1][1] - 1)], SENSOR, 2, "2 6")
    reflector(p, *meant[-1], color=MEANT, dash="4 3")
    reflector(p, *real[-1])
    p.text(24, 230, "tracker", color=SENSOR, bold=True)
    x, y = meant[-1]
    p.line([(x + 110, y - 92), (x + 14, y - 10)], INK, 2, arrow=True)
    p.text(x + 20, y - 150, "where the\nprogram means\nthe tool to be", color=INK)
    x, y = real[-1]
    p.line([(x + 50, y + 52), (x + 10, y + 14)], INK, 2, arrow=True)
    p.text(x + 56, y + 60, "where it is", color=REAL, bold=True)
    p.text(24, 36, "1  measure poses")
    p.text(24, 66, "2  calibrate a model")
    p.text(24, 96, "3  correct the commands")
    return p


def frames():
    p = Picture("The frames of a calibration: sensor, base, flange and tool", 720, 420)
    p.ground(20, 700, 380)
    p.tracker(110, 380)
    points = p.arm((370, 380), [130, 120], [10, 72], REAL)
    p.line([points[-1], (points[-1][0] + 34, points[-1][1] + 64)], REAL, 5)
    tool = (points[-1][0] + 34, points[-1][1] + 64)
    reflector(p, *tool)
    p.line([(124, 296), (tool[0] - 14, tool[1] - 2)], SENSOR, 2, "2 6")
    p.frame(44, 340, size=40, color=SENSOR)
    p.text(24, 250, "sensor frame", color=SENSOR, bold=True)
    p.frame(370, 340, size=50)
    p.text(430, 364, "base frame", bold=True)
    p.frame(*points[-1], angle=60, size=44)
    p.text(points[-1][0] + 4, points[-1][1] - 62, "flange frame", "middle", bold=True)
    p.frame(*tool, angle=60, size=44)
    p.text(tool[0] + 44, tool[1] + 6, "tool frame", bold=True)
    p.text(24, 36, "joint values  give  base to flange")
    p.text(24, 66, "identified:  sensor to base, flange to tool")
    p.text(24, 96, "measured:  sensor to tool")
    return p


def camera_frames():
    p = Picture("A camera on the flange looks at a board: the board is the sensor frame, the camera the tool frame", 720, 420)
    p.ground(20, 700, 380)
    points = p.arm((180, 380), [140, 150], [14, 78], REAL)
    x, y = points[-1]
    p.box(x + 4, y - 2, 54, 36, SENSOR, "#ffffff")
    camera = (x + 31, y + 34)
    p.line([(camera[0] - 10, camera[1]), (camera[0] - 80, 372)], SENSOR, 2, "2 6")
    p.line([(camera[0] + 10, camera[1]), (camera[0] + 120, 372)], SENSOR, 2, "2 6")
    for k in range(8):
        fill = INK if k % 2 else "#ffffff"
        p.parts.append(f'<rect x="{num(camera[0] - 90 + 26 * k)}" y="366" width="26" height="12" fill="{fill}" stroke="{INK}"/>')
    p.frame(camera[0] - 90, 360, size=40, color=SENSOR)
    p.text(camera[0] + 134, 334, "board =\nsensor frame", color=SENSOR, bold=True)
    p.frame(180, 340, size=46)
    p.text(24, 300, "base\nframe", bold=True)
    p.frame(x, y, angle=0, size=40)
    p.text(x - 8, y - 58, "flange frame", "middle", bold=True)
    p.text(x + 78, y + 26, "camera = tool frame", bold=True)
    p.text(24, 36, "identified:  board to base, and the hand-eye")
    p.text(24, 66, "transformation from flange to camera")
    return p


def nominal_and_real():
    p = Picture("Nominal and real arm with the same joint values", 720, 400)
    p.ground(20, 700, 360)
    meant = p.arm((210, 360), [130, 140, 60], [20, 62, 30], MEANT, dash="9 7")
    real = p.arm((210, 360), [136, 128, 60], [11, 84, 44], REAL)
    reflector(p, *meant[-1], color=MEANT, dash="4 3")
    reflector(p, *real[-1])
    mx, my = meant[-1]
    rx, ry = real[-1]
    p.line([(mx + 16, my), (mx + 90, my)], INK, 1.5)
    p.line([(rx + 16, ry), (rx + 90, ry)], INK, 1.5)
    p.line([(mx + 70, (my + ry) / 2), (mx + 70, max(my, ry) - 3)], INK, 2, arrow=True)
    p.line([(mx + 70, (my + ry) / 2), (mx + 70, min(my, ry) + 3)], INK, 2, arrow=True)
    p.text(mx + 102, (my + ry) / 2 + 7, "position error")
    p.line([(440, 60), (500, 60)], MEANT, 3, "9 7")
    p.text(514, 67, "nominal arm: the")
    p.text(514, 92, "controller's model")
    p.line([(440, 130), (500, 130)], REAL, 10)
    p.text(514, 137, "real arm")
    p.text(24, 36, "the same joint values,")
    p.text(24, 61, "two places of the tool")
    return p


def gate():
    p = Picture("The gate of a joint: 1 within the measured range, 0 far outside", 720, 340)
    left, right, top, bottom = 90, 690, 90, 250
    low, high, margin = 262, 506, 50
    p.line([(left, bottom), (right, bottom)], INK, 2, arrow=True)
    p.line([(left, bottom), (left, top - 30)], INK, 2, arrow=True)
    p.parts.append(f'<rect x="{low}" y="{top}" width="{high - low}" height="{bottom - top}" fill="{PALE}"/>')

    def height(x):
        out = min(max((low - x) / margin, (x - high) / margin, 0.0), 1.0)
        return 1 - out * out * (3 - 2 * out)
    p.line([(x, bottom - (bottom - top) * height(x)) for x in range(left, right - 14, 4)], REAL, 5)
    for k in range(17):
        x = low + (high - low) * (k + 0.5 + 0.28 * math.sin(5.1 * k)) / 17
        p.circle(x, bottom, 5, SENSOR, SENSOR)
    p.text(left - 14, top + 7, "1", "end")
    p.text(left - 14, bottom + 7, "0", "end")
    p.text(left - 60, top - 42, "gate")
    p.text(right, bottom + 34, "joint value", "end")
    p.text((low + high) / 2, bottom + 34, "measured poses", "middle", color=SENSOR, bold=True)
    p.text((low + high) / 2, top + 66, "whole model", "middle", bold=True)
    p.text(left + 8, top + 120, "geometry", bold=True)
    p.text(right - 14, top + 120, "geometry", "end", bold=True)
    return p


def joint_error():
    p = Picture("The error of a joint over its angle, and the orders that it consists of", 720, 330)
    left, right, middle = 70, 690, 190
    p.line([(left, middle), (right, middle)], INK, 2, arrow=True)
    p.line([(left, 300), (left, 80)], INK, 2, arrow=True)

    def slow(a):
        return 52 * math.sin(a + 0.6) + 24 * math.cos(2 * a)
    scale = (right - left - 40) / (2 * math.pi)
    angles = [2 * math.pi * k / 600 for k in range(601)]
    p.line([(left + scale * a, middle - slow(a) - 12 * math.sin(41 * a)) for a in angles], REAL, 2.5)
    p.line([(left + scale * a, middle - slow(a)) for a in angles], SENSOR, 4, "12 8")
    p.text(20, 60, "error of joint 5")
    p.text(right, middle + 62, "joint angle,", "end")
    p.text(right, middle + 87, "one turn", "end")
    p.line([(330, 34), (380, 34)], SENSOR, 4, "12 8")
    p.text(392, 41, "low orders: assembly")
    p.line([(330, 70), (380, 70)], REAL, 2.5)
    p.text(392, 77, "with a line of the gear")
    return p


def selection():
    p = Picture("How a stage is chosen: fit a block of unknowns, leave poses out, keep it or drop it", 720, 430)
    steps = [("frames", "base and tool"), ("geometry", "links and zeros"), ("one more block", "gears, play, drift")]
    for k, (name, what) in enumerate(steps):
        x = 20 + 235 * k
        p.box(x, 20, 205, 84)
        p.text(x + 102, 54, name, "middle", bold=True)
        p.text(x + 102, 84, what, "middle")
        if k < 2:
            p.line([(x + 209, 62), (x + 231, 62)], INK, 2.5, arrow=True)
    p.line([(592, 108), (592, 146)], INK, 2.5, arrow=True)
    p.box(490, 150, 205, 84, REAL, "#ffffff")
    p.text(592, 184, "does it exist, and", "middle")
    p.text(592, 212, "does it predict?", "middle")
    p.line([(592, 238), (592, 286)], INK, 2.5, arrow=True)
    p.text(606, 270, "yes")
    p.box(490, 290, 205, 60)
    p.text(592, 327, "keep the block", "middle", bold=True)
    p.line([(486, 192), (449, 192)], INK, 2.5, arrow=True)
    p.text(468, 180, "no", "middle")
    p.box(240, 162, 205, 60)
    p.text(342, 199, "drop the block", "middle", bold=True)
    p.line([(342, 158), (342, 130), (475, 130), (505, 108)], MEANT, 2.5, "7 6", arrow=True)
    p.text(232, 146, "next block", "middle")
    p.line([(699, 310), (711, 310), (711, 62), (699, 62)], MEANT, 2.5, "7 6", arrow=True)
    p.line([(486, 320), (449, 320)], INK, 2.5, arrow=True)
    p.box(240, 278, 205, 84, REAL, "#ffffff")
    p.text(342, 312, "a learner on the", "middle")
    p.text(342, 340, "residual: lower?", "middle")
    p.line([(236, 320), (209, 320)], INK, 2.5, arrow=True)
    p.box(20, 278, 185, 84)
    p.text(112, 312, "deploy; held-out", "middle")
    p.text(112, 340, "poses judge it", "middle")
    p.text(20, 408, "All unknowns that were kept are estimated together at every step.")
    return p


def main():
    folder = pathlib.Path(__file__).resolve().parent
    different = []
    for draw in (task, frames, camera_frames, nominal_and_real, gate, joint_error, selection):
        file, text = folder / f"{draw.__name__}.svg", draw().svg()
        if sys.argv[1:] == ["--check"]:
            if not file.exists() or file.read_text() != text:
                different.append(file.name)
        else:
            file.write_text(text)
    if different:
        sys.exit(f"{', '.join(different)}: not what docs/figures/draw.py draws")


if __name__ == "__main__":
    main()
