"""Names that the SSP 1.0 documents share: namespaces, schemas, and the name of the parameter sets we write."""

from __future__ import annotations

import importlib.util
from pathlib import Path

SSP_1 = "http://ssp-standard.org/SSP1/"
NAMESPACES = {
    "ssc": f"{SSP_1}SystemStructureCommon",
    "ssd": f"{SSP_1}SystemStructureDescription",
    "ssv": f"{SSP_1}SystemStructureParameterValues",
    "ssm": f"{SSP_1}SystemStructureParameterMapping",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
OSP, OMS = "com.opensimulationplatform", "org.openmodelica"  # types of annotations: libcosim's and OMSimulator's
MAIN = "SystemStructure.ssd"
RESOURCES = "resources"
PARAMETER_SET = "initialValues"  # hosts apply one set by name to all components: ours all have this one


def schema(name: str) -> Path:
    """Path of an SSP 1.0 schema file, as FMPy ships it (found without importing FMPy)."""
    package = importlib.util.find_spec("fmpy")
    return Path(package.origin).parent / "ssp" / "schema" / f"{name}.xsd"
