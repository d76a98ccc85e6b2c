"""Names of the components of a field, in the order of the file."""

from tessera_post.fields import COMPONENTS, GRADIENT, TENSORS, VECTORS

SYMMETRIC = tuple(COMPONENTS)[:6]


def component_names(field: str, n_components: int) -> list[str]:
    """What follows the name of a field: 11, 22, ... of a tensor, 1, 2, 3 of a vector, nothing of
    a scalar; components of a field that we do not know are counted from 1."""
    if n_components == 1:
        return [""]
    if field in TENSORS and n_components == len(SYMMETRIC):
        return list(SYMMETRIC)
    if field == "F" and n_components == len(GRADIENT):
        return list(GRADIENT)
    separator = "" if field in VECTORS else "_"
    return [f"{separator}{i + 1}" for i in range(n_components)]
