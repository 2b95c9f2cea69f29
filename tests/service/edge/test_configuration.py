"""Wrong configurations of the edge agent: a line says what would be right."""

from pathlib import Path

import pytest

from formats.files.document_files import UnreadableFile
from service.edge.configuration import read_configuration


@pytest.mark.parametrize(("content", "said"), [("", "is empty"), ("speed_rpm,B1L_um_pp", "holds no fields")])
def test_a_file_without_fields_is_told_which_a_configuration_has(tmp_path: Path, content: str, said: str) -> None:
    path = tmp_path / "edge.yaml"
    path.write_text(content)
    with pytest.raises(UnreadableFile, match=rf"edge\.yaml {said}: .* has machine, waveforms, keyphasor") as raised:
        read_configuration(path)
    assert "\n" not in str(raised.value)
