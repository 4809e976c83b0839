//! The events of a machine: alarms as `AlertType`, messages of the program as a subtype of `NotificationEventType`. The
//! library has no state machine of conditions: an alarm is an event when it comes and one when it goes, and is acknowledged
//! at the machine.
//! Source: OPC 10000-9 (alarms and conditions), OPC 40501-1 8.6.

use std::collections::BTreeMap;

use opcua::nodes::{Event, EventField};
use opcua::types::{
    AttributeId, DateTime, LocalizedText, NodeId, NumericRange, ObjectTypeId, QualifiedName, StatusCode, Variant,
};

use super::adapter_state::ToldAlarm;
use super::machine_tool::MachineNodes;
use super::node_builder::path_of;

/// Severities by OPC 40501-1: errors from 667, warnings from 334, messages below.
const FAULT_SEVERITY: u16 = 800;
const WARNING_SEVERITY: u16 = 500;
const MESSAGE_SEVERITY: u16 = 200;

/// An event with its fields.
pub struct AlertEvent {
    time: DateTime,
    kind: NodeId,
    /// The types that it is of, by which clients name its fields.
    types: Vec<NodeId>,
    /// The condition; none for a message.
    condition: Option<NodeId>,
    /// By their paths: `ActiveState/Id`.
    fields: BTreeMap<&'static str, Variant>,
}

impl AlertEvent {
    /// An alarm that is raised, or over.
    #[must_use]
    pub fn of_alarm(nodes: &MachineNodes, alarm: &ToldAlarm, is_active: bool, time: DateTime) -> Self {
        let severity = if alarm.is_fault { FAULT_SEVERITY } else { WARNING_SEVERITY };
        let text = if alarm.text.is_empty() { format!("alarm {}", alarm.number) } else { alarm.text.clone() };
        let mut event = Self::new(nodes, nodes.alert_type.clone(), &text, (severity, time));
        let supertypes =
            [ObjectTypeId::ConditionType, ObjectTypeId::AcknowledgeableConditionType, ObjectTypeId::AlarmConditionType];
        event.types.extend(supertypes.map(NodeId::from));
        let name = format!("{} {}", alarm.condition.trim_start_matches("c_"), alarm.number);
        let above = path_of(&nodes.messages);
        event.condition = Some(NodeId::new(nodes.messages.namespace, format!("{above}/{name}")));
        let state = |word: &str| Variant::from(LocalizedText::new("en", word));
        let fields = [
            ("ErrorCode", Variant::from(alarm.number.clone())),
            ("ConditionName", Variant::from(name)),
            ("ConditionClassId", Variant::from(NodeId::from(ObjectTypeId::ProcessConditionClassType))),
            ("ConditionClassName", state("ProcessConditionClass")),
            ("BranchId", Variant::from(NodeId::null())),
            ("Retain", Variant::Boolean(is_active)),
            ("EnabledState", state("Enabled")),
            ("EnabledState/Id", Variant::Boolean(true)),
            ("Quality", Variant::from(StatusCode::Good)),
            ("LastSeverity", Variant::UInt16(severity)),
            ("Comment", state("")),
            ("ClientUserId", Variant::from("")),
            ("AckedState", state("Acknowledged")),
            ("AckedState/Id", Variant::Boolean(true)),
            ("ActiveState", state(if is_active { "Active" } else { "Inactive" })),
            ("ActiveState/Id", Variant::Boolean(is_active)),
            ("InputNode", Variant::from(NodeId::null())),
            ("SuppressedOrShelved", Variant::Boolean(false)),
        ];
        event.fields.extend(fields);
        event
    }

    /// A message of the program.
    #[must_use]
    pub fn of_message(nodes: &MachineNodes, text: &str, time: DateTime) -> Self {
        let [kind, above] = nodes.message_types.clone();
        let mut event = Self::new(nodes, kind, text, (MESSAGE_SEVERITY, time));
        event.types.push(above);
        event.fields.insert("Identifier", Variant::from("message"));
        event
    }

    fn new(nodes: &MachineNodes, kind: NodeId, text: &str, (severity, time): (u16, DateTime)) -> Self {
        let fields = [
            ("EventId", Variant::from(opcua::crypto::random::byte_string(16))),
            ("EventType", Variant::from(kind.clone())),
            ("SourceNode", Variant::from(nodes.root.clone())),
            ("SourceName", Variant::from(path_of(&nodes.root))),
            ("Time", Variant::from(time)),
            ("ReceiveTime", Variant::from(DateTime::now())),
            ("Message", Variant::from(LocalizedText::new("en", text))),
            ("Severity", Variant::UInt16(severity)),
        ];
        let types = vec![kind.clone(), ObjectTypeId::BaseEventType.into()];
        Self { time, kind, types, condition: None, fields: fields.into() }
    }
}

impl EventField for AlertEvent {
    fn get_value(&self, attribute: AttributeId, range: &NumericRange, path: &[QualifiedName]) -> Variant {
        if attribute == AttributeId::NodeId && path.is_empty() {
            return self.condition.clone().map_or(Variant::Empty, Variant::from);
        }
        if attribute != AttributeId::Value || !matches!(range, NumericRange::None) {
            return Variant::Empty;
        }
        let path: Vec<&str> = path.iter().map(|name| name.name.as_ref()).collect();
        self.fields.get(path.join("/").as_str()).cloned().unwrap_or(Variant::Empty)
    }
}

impl Event for AlertEvent {
    fn get_field(&self, of: &NodeId, attribute: AttributeId, range: &NumericRange, path: &[QualifiedName]) -> Variant {
        if self.types.contains(of) { self.get_value(attribute, range, path) } else { Variant::Empty }
    }

    fn time(&self) -> &DateTime {
        &self.time
    }

    fn event_type_id(&self) -> &NodeId {
        &self.kind
    }
}
