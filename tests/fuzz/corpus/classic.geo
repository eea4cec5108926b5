PGEOMETRY V5
NPoints 2 NPrims 0
NPointGroups 0 NPrimGroups 0
NPointAttrib 2 NVertexAttrib 0 NPrimAttrib 0 NAttrib 0
PointAttrib
id 1 int 0
kind 1 index 2 "a b" c
0 1 2 1 (5	0)
3 4 5 1 (6	1)
beginExtra
endExtra
