"""Names and units of the metrics that an edge node speaking Sparkplug B sends for a machine."""

from typing import Annotated, Literal

from pydantic import Field

from estimator.field_types import Identifier, Part, Text

TopicLevel = Annotated[Text, Field(min_length=1, max_length=100, pattern=r"^[^/+#]+$")]
Metric = Annotated[Text, Field(min_length=1, max_length=200)]


class SparkplugChannel(Part):
    """Names of the metrics of one probe."""

    amplitude: Metric = Field(description="name of the metric that is its amplitude")
    phase: Metric = Field(description="name of the metric that is its phase")
    gap: Metric | None = Field(
        default=None, description="name of the metric that is its mean gap; the probe's `gap_grows` says which way it grows"
    )
    overall: Metric | None = Field(
        default=None, description="name of the metric that is its unfiltered vibration, in unit and kind of the amplitude"
    )


class Sparkplug(Part):
    """Sources of the machine's metrics, `spBv1.0/<group>/…/<node>/<device>`, and what each is."""

    group: TopicLevel = Field(description="of the edge node, as in its topics")
    node: TopicLevel = Field(description="the edge node's own name")
    device: TopicLevel | None = Field(default=None, description="of the node; by default the node's own metrics")
    speed: Metric = Field(description="name of the metric that is the speed")
    channels: Annotated[dict[Identifier, SparkplugChannel], Field(min_length=1, max_length=120)] = Field(
        description="by probe of the document"
    )
    conditions: Annotated[dict[Identifier, Metric], Field(max_length=16)] = Field(
        default={}, description="names of metrics by operating condition of the document"
    )
    speed_unit: Literal["rpm", "rad/s", "Hz"] = Field(default="rpm", description="what the speed is sent in")
    amplitude_unit: Literal["um", "mil", "mm", "m", "V"] = Field(default="um", description="what amplitudes are sent in")
    amplitude_kind: Literal["peak", "peak-to-peak"] = Field(
        default="peak-to-peak", description="whether amplitudes are from zero or from peak to peak"
    )
    gap_unit: Literal["um", "mil", "mm", "m", "V"] = Field(default="um", description="what gaps are sent in")
    phase_convention: Literal["lag", "lead"] = Field(default="lag", description="whether phases lag or lead")
    phase_unit: Literal["deg", "rad"] = Field(default="deg", description="what phases are sent in")
