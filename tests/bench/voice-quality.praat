# SPDX-License-Identifier: GPL-3.0-or-later
# H1-H2, harmonicity, jitter and shimmer of a recording, for models/expressions.md: praat --run voice-quality.praat FILE.wav
form Measure
  sentence file
endform
s = Read from file: file$
h = To Harmonicity (cc): 0.01, 75, 0.1, 1.0
hnr = Get mean: 0, 0
selectObject: s
pp = To PointProcess (periodic, cc): 75, 500
jit = Get jitter (rap): 0, 0, 0.0001, 0.02, 1.3
selectObject: s, pp
shi = Get shimmer (local_dB): 0, 0, 0.0001, 0.02, 1.3, 1.6
selectObject: s
p = To Pitch: 0.01, 75, 500
n = Get number of frames
sum = 0
c = 0
for i to n
  selectObject: p
  f0 = Get value in frame: i, "Hertz"
  if f0 <> undefined
    t = Get time from frame number: i
    selectObject: s
    ex = Extract part: t - 0.025, t + 0.025, "Hanning", 1, "no"
    sp = To Spectrum: "yes"
    l = To Ltas (1-to-1)
    a = Get maximum: f0 * 0.85, f0 * 1.15, "none"
    b = Get maximum: f0 * 1.85, f0 * 2.15, "none"
    if a <> undefined and b <> undefined
      sum = sum + a - b
      c = c + 1
    endif
    removeObject: ex, sp, l
  endif
endfor
writeInfoLine: file$, "  H1-H2 ", fixed$ (sum / c, 1), "  HNR ", fixed$ (hnr, 1), "  jitter ", fixed$ (100 * jit, 2), " %  shimmer ", fixed$ (shi, 2), " dB"
