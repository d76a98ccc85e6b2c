"""Small gmsh meshes as data, and how they are written in the formats 2.2 and 4.1."""

import itertools
from dataclasses import dataclass, field
from random import Random

from fuzzing import words

EDGES = {2: ((0, 1), (1, 2), (2, 0)), 3: ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))}
LINEAR, QUADRATIC = {0: 15, 1: 1, 2: 2, 3: 4}, {0: 15, 1: 8, 2: 9, 3: 11}


@dataclass
class Block:
    """Elements of one geometric entity."""

    dim: int
    tag: int
    groups: list[int]
    kind: int  # gmsh type
    elements: list[list[int]]  # tag and nodes


@dataclass
class Model:
    """A mesh; tags are integers, or texts after a mutation."""

    dim: int
    nodes: dict = field(default_factory=dict)  # tag and coordinates
    blocks: list[Block] = field(default_factory=list)
    names: list[tuple] = field(default_factory=list)  # dimension, number, name


def box(dim: int, order: int, cells: int) -> Model:
    """A box of simplices with the groups BODY and LEFT."""
    n = cells + 1
    model = Model(dim, names=[(dim, 1, "BODY"), (dim - 1, 2, "LEFT")])
    index = {}
    for tag, place in enumerate(itertools.product(range(n), repeat=dim), 1):
        index[place] = tag
        model.nodes[tag] = [float(x) for x in place] + [0.0] * (3 - dim)
    simplices, faces = [], set()
    for corner in itertools.product(range(cells), repeat=dim):
        for way in itertools.permutations(range(dim)):
            path = [list(corner)]
            for axis in way:
                path.append([*path[-1]])
                path[-1][axis] += 1
            nodes = [index[tuple(p)] for p in path]
            odd = sum(a > b for i, a in enumerate(way) for b in way[i + 1 :]) % 2
            if odd:
                nodes[0], nodes[1] = nodes[1], nodes[0]
            simplices.append(nodes)
            left = [v for v in nodes if model.nodes[v][0] == 0.0]
            if len(left) == dim:
                faces.add(tuple(left))
    kinds = LINEAR
    body, carrier = simplices, [list(face) for face in sorted(faces)]
    if order == 2:
        kinds, mid = QUADRATIC, {}
        body = [quadratic(model, mid, nodes, EDGES[dim]) for nodes in body]
        edges = EDGES[2] if dim == 3 else ((0, 1),)
        carrier = [quadratic(model, mid, nodes, edges) for nodes in carrier]
    tag = itertools.count(1)
    for d, groups, elements in ((dim - 1, [2], carrier), (dim, [1], body)):
        model.blocks.append(Block(d, 1, groups, kinds[d], [[next(tag), *e] for e in elements]))
    return model


def quadratic(model: Model, mid: dict, nodes: list[int], edges: tuple) -> list[int]:
    """The nodes with those in the middles of the edges."""
    more = []
    for a, b in edges:
        key = tuple(sorted((nodes[a], nodes[b])))
        if key not in mid:
            mid[key] = len(model.nodes) + 1
            ends = model.nodes[nodes[a]], model.nodes[nodes[b]]
            model.nodes[mid[key]] = [(x + y) / 2 for x, y in zip(*ends)]
        more.append(mid[key])
    return nodes + more


def sections_22(model: Model) -> list[list[str]]:
    """The sections of format 2.2 as lines."""
    lines = []
    for block in model.blocks:
        for group in block.groups or [0]:
            lines += [
                f"{tag} {block.kind} 2 {group} {block.tag} " + " ".join(map(str, nodes))
                for tag, *nodes in block.elements
            ]
    return [
        ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"],
        names(model),
        ["$Nodes", f"{len(model.nodes)}", *coordinates(model, True), "$EndNodes"],
        ["$Elements", f"{len(lines)}", *lines, "$EndElements"],
    ]


def sections_41(model: Model) -> list[list[str]]:
    """The sections of format 4.1 as lines."""
    entities = [b for dim in range(4) for b in model.blocks if b.dim == dim]
    counts = [sum(b.dim == dim for b in entities) for dim in range(4)]
    entity_lines = [
        f"{b.tag} " + "0 0 0 " * (1 if b.dim == 0 else 2) + f"{len(b.groups)} "
        + " ".join(map(str, b.groups)) + (" 0" if b.dim > 0 else "")
        for b in entities
    ]  # fmt: skip
    n_elements = sum(len(b.elements) for b in model.blocks)
    elements = []
    for b in model.blocks:
        elements.append(f"{b.dim} {b.tag} {b.kind} {len(b.elements)}")
        elements += [" ".join(map(str, element)) for element in b.elements]
    n = len(model.nodes)
    return [
        ["$MeshFormat", "4.1 0 8", "$EndMeshFormat"],
        names(model),
        ["$Entities", " ".join(map(str, counts)), *entity_lines, "$EndEntities"],
        ["$Nodes", f"1 {n} 1 {n}", f"{model.dim} 1 0 {n}", *map(str, model.nodes),
         *coordinates(model, False), "$EndNodes"],
        ["$Elements", f"{len(model.blocks)} {n_elements} 1 {n_elements}", *elements,
         "$EndElements"],
    ]  # fmt: skip


def names(model: Model) -> list[str]:
    """Section of the names of groups."""
    lines = [f'{dim} {number} "{name}"' for dim, number, name in model.names]
    return ["$PhysicalNames", str(len(lines)), *lines, "$EndPhysicalNames"]


def coordinates(model: Model, with_tag: bool) -> list[str]:
    """Lines of nodes."""
    return [
        (f"{tag} " if with_tag else "") + " ".join(map(str, x)) for tag, x in model.nodes.items()
    ]


# --- mutations of the data: what is written stays well-formed -------------------------------------


def renumber(random: Random, model: Model) -> None:
    """Tags of nodes with gaps, up to the largest number of some width."""
    bits = random.choice((10, 31, 31, 32, 40, 62, 63, 64))
    tags: set[int] = set()
    while len(tags) < len(model.nodes):
        tags.add(random.getrandbits(bits) or 1)
    new = dict(zip(model.nodes, tags))
    model.nodes = {new[tag]: x for tag, x in model.nodes.items()}
    for block in model.blocks:
        block.elements = [[e[0], *(new.get(v, v) for v in e[1:])] for e in block.elements]


def renumber_elements(random: Random, model: Model) -> None:
    """Tags of elements with gaps, negative or twice the same."""
    most = 2 ** random.choice((3, 31, 62))
    for block in model.blocks:
        for element in block.elements:
            element[0] = random.randint(-1 if random.random() < 0.1 else 1, most)


def degenerate(random: Random, model: Model) -> None:
    """A node twice in an element, or two nodes in one place."""
    if random.random() < 0.5:
        element = some_element(random, model)
        element[random.randrange(1, len(element))] = random.choice(element[1:])
    else:
        a, b = random.choice(list(model.nodes)), random.choice(list(model.nodes))
        model.nodes[a] = list(model.nodes[b])


def invert(random: Random, model: Model) -> None:
    """The nodes of an element in another order."""
    element = some_element(random, model)
    nodes = element[1:]
    random.shuffle(nodes)
    element[1:] = nodes


def non_manifold(random: Random, model: Model) -> None:
    """A third element on a face, or an element twice."""
    block = random.choice(model.blocks)
    element = list(random.choice(block.elements))
    element[0] = random.choice((1000, element[0]))
    for _ in range(random.randrange(3)):
        element[random.randrange(1, len(element))] = random.choice(list(model.nodes))
    block.elements.append(element)


def move_node(random: Random, model: Model) -> None:
    """A node somewhere else, far away or nearly where it was."""
    x = random.choice(list(model.nodes.values()))
    i = random.randrange(3)
    if random.random() < 0.5:
        x[i] = words.number(random)
    else:
        x[i] = float(x[i]) + random.choice((1e-16, 1e-9, 1e-3, 0.5, -3.0, 1e9)) if isinstance(
            x[i], float) else "7"  # fmt: skip


def scale(random: Random, model: Model) -> None:
    """The whole mesh very large or very small, or flat."""
    factor = 10.0 ** random.choice((-320, -300, -150, -100, -50, -8, 8, 50, 99, 101, 110, 160, 300))
    axes = random.choice(((0, 1, 2), (0,), (1,)))
    for x in model.nodes.values():
        for i in axes:
            x[i] = float(x[i]) * factor if isinstance(x[i], float) else x[i]


def change_type(random: Random, model: Model) -> None:
    """Another type, dimension or entity for a block."""
    block = random.choice(model.blocks)
    kind = random.randrange(4)
    if kind == 0:
        block.kind = random.choice((0, 1, 2, 3, 4, 5, 8, 9, 11, 15, 16, 21, 99, -1))
    elif kind == 1:
        block.dim = random.choice((-1, 0, 1, 2, 3, 4))
    elif kind == 2:
        block.tag = random.choice((0, -1, 2, 2**31 - 1))
    else:
        block.groups = random.choice(([], [0], [1, 2], [2, 1], [-1], [1, 1], [7], [2**31 - 1]))


def change_names(random: Random, model: Model) -> None:
    """Groups of other names, without names, with one name for two."""
    if random.random() < 0.3:
        model.names = random.choice(([], model.names * 2, model.names[:1]))
        return
    name = words.word(random)
    model.names.append((random.choice((0, 1, 2, 3, 4, -1)), random.choice((1, 2, 7, -1)), name))
    if random.random() < 0.5:
        del model.names[0]


def drop_some(random: Random, model: Model) -> None:
    """A block, an element or a node less."""
    kind = random.randrange(3)
    if kind == 0:
        del model.blocks[random.randrange(len(model.blocks))]
        model.blocks = model.blocks or [Block(2, 1, [1], 2, [[1, 1, 2, 3]])]
    elif kind == 1:
        del model.nodes[random.choice(list(model.nodes))]
        model.nodes = model.nodes or {1: [0.0, 0.0, 0.0]}
    else:
        elements = random.choice(model.blocks).elements
        if len(elements) > 1:
            del elements[random.randrange(len(elements))]


def some_element(random: Random, model: Model) -> list:
    """An element, its tag first."""
    return random.choice(random.choice(model.blocks).elements)


ON_MODEL = (
    renumber, renumber_elements, degenerate, invert, non_manifold, move_node, move_node, scale,
    change_type, change_type, change_names, drop_some,
)  # fmt: skip
